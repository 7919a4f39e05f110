// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/command.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>

#include "hexaplast/base/error.hpp"
#include "record/files.hpp"
#include "scene/reader.hpp"

namespace hexaplast::runner {

int report(ExitCode code, const std::string& message) {
  spdlog::error("{}", message);
  return code;
}

int report_errors(const std::string& subject, const std::function<int()>& action) {
  try {
    const int code = action();
    flush_standard_output();
    return code;
  } catch (const UsageError& error) {
    return report(kUsage, scene::format_error({"hexaplast", 0}, error.what(), error.hint()));
  } catch (const scene::OverrideError& error) {
    return report(kUsage, error.what());
  } catch (const scene::SceneError& error) {
    return report(kScene, error.what());
  } catch (const InputError& error) {
    return report(kScene, scene::format_error({subject, 0}, error.what()));
  } catch (const std::bad_alloc&) {
    return report(kScene, scene::format_error({subject, 0}, "it does not fit into memory"));
  } catch (const NumericalError& error) {
    return report(kNumerical, scene::format_error({subject, 0}, error.what()));
  } catch (const scene::FileError& error) {
    return report(kInputOutput, error.what());
  } catch (const scene::PluginError& error) {
    return report(kPlugin, error.what());
  } catch (const std::exception& error) {  // OutputError, and what the system refuses: threads, locales, files
    return report(kInputOutput, scene::format_error({"hexaplast", 0}, error.what()));
  }
}

std::vector<double> numbers_in(std::string_view text, char separator) {
  std::vector<double> all;
  while (true) {
    const std::size_t length = text.substr(0, text.find(separator)).size();
    std::string_view digits = text.substr(0, length);
    digits.remove_prefix(std::min(digits.find_first_not_of(' '), length));
    double number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(number)) return {};
    all.push_back(number);
    if (length == text.size()) return all;
    text.remove_prefix(length + 1);
  }
}

void flush_standard_output() {
  std::cout.flush();
  if (!std::cout || std::fflush(stdout) != 0 || std::ferror(stdout))
    throw output::OutputError("standard output cannot be written");
}

}  // namespace hexaplast::runner
