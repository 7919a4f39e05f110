// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/packed_numbers.hpp"

#include <zlib.h>

#include "formats/base64.hpp"
#include "record/files.hpp"

namespace hexaplast::output {

std::string PackedNumbers::base64() const {
  uLongf size = compressBound(bytes_.size());
  std::string deflated(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(deflated.data()), &size, reinterpret_cast<const Bytef*>(bytes_.data()),
                bytes_.size(), Z_DEFAULT_COMPRESSION) != Z_OK)
    throw OutputError("the states of the viewer cannot be deflated");
  deflated.resize(size);
  return to_base64(deflated);
}

}  // namespace hexaplast::output
