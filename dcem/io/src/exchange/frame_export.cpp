#include "dcem/io/src/exchange/frame_export.hpp"

#include <stdexcept>

#include "dcem/io/src/exchange/column_export.hpp"
#include "dcem/io/src/exchange/deepmimo_export.hpp"
#include "dcem/io/src/exchange/gltf_export.hpp"
#include "dcem/io/src/exchange/kml_export.hpp"
#include "dcem/io/src/exchange/p2m_export.hpp"
#include "dcem/io/src/exchange/qd_export.hpp"

namespace dcem::io {

std::vector<std::unique_ptr<FrameExport>> make_exports(const ExportContext& context) {
  const ExchangeSettings& wanted = context.output.exchange;
  std::vector<std::unique_ptr<FrameExport>> exports;
  if (wanted.hdf5) exports.push_back(std::make_unique<Hdf5Export>(context));
  if (wanted.qd) exports.push_back(std::make_unique<QdExport>(context));
  if (wanted.p2m) exports.push_back(std::make_unique<P2mExport>(context));
  if (wanted.deepmimo) exports.push_back(std::make_unique<DeepMimoExport>(context));
  if (wanted.kml) exports.push_back(std::make_unique<KmlExport>(context));
  if (wanted.gltf) exports.push_back(std::make_unique<GltfExport>(context));
  return exports;
}

bool wants_exports(const OutputSettings& output) {
  const ExchangeSettings& wanted = output.exchange;
  return wanted.hdf5 || wanted.qd || wanted.p2m || wanted.deepmimo || wanted.kml || wanted.gltf;
}

Frame frame_now(const Scene& scene, const FrameResult& result) {
  Frame frame{result.index, result.time_s, {}};
  for (std::size_t body = 0; body < scene.bodies().size(); ++body)
    frame.bodies.push_back(scene.body_state(BodyId(body)));
  return frame;
}

std::vector<const LinkResult*> links_by_ends(const FrameResult& frame, std::size_t transmitters,
                                             std::size_t receivers) {
  std::vector<const LinkResult*> links(transmitters * receivers, nullptr);
  for (const LinkResult& link : frame.links) links[link.transmitter * receivers + link.receiver] = &link;
  return links;
}

void require_single_ports(const ExportContext& context, const std::string& what) {
  for (const auto devices : {context.scene.transmitters(), context.receivers}) {
    for (const Device& device : devices) {
      if (!device.antenna.is_dual()) continue;
      throw std::invalid_argument(what + ", and device '" + device.id +
                                  "' is VH; expected polarizations with one port (or output.npz)");
    }
  }
}

}  // namespace dcem::io
