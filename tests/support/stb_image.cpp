// The library behind tests/io/png_reader.hpp, compiled once.
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>
