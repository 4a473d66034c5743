// How a tree is built and follows motion.
#include "dcem/accel/wide/update/degradation_bodies.hpp"
#include "dcem/accel/wide/update/updater_bodies.hpp"
#include "dcem/accel/wide_bvh_bodies.hpp"
#include "dcem/accel/wide_bvh_rebuild_bodies.hpp"
#include "dcem/accel/wide_bvh_refit_bodies.hpp"
#include "dcem/accel/wide_bvh_rotate_bodies.hpp"
