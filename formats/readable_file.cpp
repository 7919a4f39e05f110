// SPDX-License-Identifier: LGPL-2.1-or-later
#include "formats/readable_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>

#include "hexaplast/base/error.hpp"

namespace hexaplast {

std::string why_unreadable(const std::filesystem::path& file) {
  const auto refusal = [](const std::error_code& reason) { return "cannot be read: " + reason.message(); };
  std::error_code failure;
  const std::filesystem::file_status status = std::filesystem::status(file, failure);
  if (status.type() == std::filesystem::file_type::not_found) return "no such file";
  if (failure) return refusal(failure);
  if (!std::filesystem::is_regular_file(status)) return "is not a file";
  if (::access(file.c_str(), R_OK) != 0) return refusal({errno, std::generic_category()});
  return {};
}

std::string whole_file(const std::filesystem::path& file) {
  const auto refuse = [&](std::string_view what) { throw InputError(fmt::format("{}: {}", file.string(), what)); };
  if (const std::string reason = why_unreadable(file); !reason.empty()) refuse(reason);
  std::error_code failure;
  std::string content(std::filesystem::file_size(file, failure), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(content.data(), static_cast<std::streamsize>(content.size()));
  if (failure || !stream) refuse("cannot be read");
  return content;
}

}  // namespace hexaplast
