// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <memory>

#include "record/files.hpp"
#include "record/state_stream.hpp"

namespace hexaplast::runner {

/// The HDF5 file of `run --data`: written by the program hexaplast-data from a stream of states. It is there whole or
/// not at all (WholeFile). All throw OutputError.
class DataFile {
 public:
  /// Starts the program and waits until it is ready, so that no long run ends with packages that are missing.
  DataFile(const std::filesystem::path& file, output::Bodies bodies, output::StatePlan plan);
  ~DataFile();  ///< without complete(): removes what there is
  DataFile(const DataFile&) = delete;
  DataFile& operator=(const DataFile&) = delete;

  output::StateStream& states() { return *states_; }
  void complete(const output::NamedTexts& attributes);  ///< puts the file in place

 private:
  int wait();  ///< for the end of the program: its exit code

  std::filesystem::path path_;
  output::WholeFile part_;
  int socket_ = -1;
  pid_t program_ = -1;
  std::unique_ptr<output::StateStream> states_;
};

}  // namespace hexaplast::runner
