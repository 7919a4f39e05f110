// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>

#include "picture/renderer.hpp"

namespace hexaplast::output {

/// Writes an image as PNG (8-bit RGB). Throws OutputError.
void write_png(const std::filesystem::path& file, const Image& image);

}  // namespace hexaplast::output
