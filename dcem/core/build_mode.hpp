#pragma once
/// How the engine reaches a program: as headers alone, or compiled once in the library `dcem::engine`.
///
/// Who links `dcem::engine` gets the definition DCEM_ENGINE by CMake: then headers declare what the library holds, and
/// bring no body of it. Otherwise the bodies follow the declarations as inline functions. All of a program must be
/// compiled in one of the two ways.

#if defined(DCEM_ENGINE)
#define DCEM_INLINE
#else
#define DCEM_INLINE inline
#endif
