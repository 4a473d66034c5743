# Run at build time with -P: writes a C++ source that holds files as bytes.
#   OUT       the source to write
#   FUNCTION  name of the function in dcem::io that gives the bytes
#   FILES     the files, one after the other, separated by '|'; none: no bytes
string(REPLACE "|" ";" files "${FILES}")
set(bytes "")
foreach(path IN LISTS files)
  file(READ "${path}" hex HEX)
  string(APPEND bytes "${hex}")
endforeach()
# A byte is at most "0xff,"; lines of 32 keep compilers and editors quick.
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," values "${bytes}")
string(REGEX REPLACE "(................................................................................................................................................................)" "\\1\n" values "${values}")
file(WRITE "${OUT}" "#include \"dcem/io/src/viewer/viewer_page.hpp\"

namespace dcem::io {

std::string_view ${FUNCTION}() {
  static const unsigned char bytes[] = {
${values}0x00};
  return {reinterpret_cast<const char*>(bytes), sizeof(bytes) - 1};
}

}  // namespace dcem::io
")
