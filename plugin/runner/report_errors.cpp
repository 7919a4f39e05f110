// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/report_errors.hpp"

#include <spdlog/spdlog.h>

#include <exception>
#include <filesystem>
#include <new>

#include "hexaplast/base/error.hpp"
#include "record/recorder.hpp"
#include "runner/standard_output.hpp"
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
  } catch (const output::OutputError& error) {
    return report(kInputOutput, scene::format_error({"hexaplast", 0}, error.what()));
  } catch (const std::filesystem::filesystem_error& error) {
    return report(kInputOutput, scene::format_error({"hexaplast", 0}, error.what()));
  } catch (const scene::PluginError& error) {
    return report(kPlugin, error.what());
  } catch (const std::exception& error) {  // what the system refuses: threads, locales, files
    return report(kInputOutput, scene::format_error({"hexaplast", 0}, error.what()));
  }
}

}  // namespace hexaplast::runner
