// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/field_file.hpp"

#include <dlfcn.h>

#include <algorithm>

#include "record/files.hpp"

namespace hexaplast::output {
namespace fs = std::filesystem;

namespace {

/// The module beside the library that this function is in. It stays loaded.
const FieldFileModule& module_with_hdf5() {
  static const FieldFileModule& loaded = []() -> const FieldFileModule& {
    Dl_info here{};
    if (::dladdr(reinterpret_cast<void*>(&field_of), &here) == 0 || !here.dli_fname)
      throw OutputError("HDF5 files cannot be written: the place of this library is not known");
    const fs::path file = fs::absolute(here.dli_fname).parent_path() / "hexaplast" / HEXAPLAST_FIELD_FILE_MODULE;
    void* module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!module) throw OutputError(std::string("HDF5 files cannot be written: ") + ::dlerror());
    void* symbol = ::dlsym(module, HEXAPLAST_FIELD_FILE_ENTRY);
    if (!symbol) throw OutputError(file.string() + ": belongs to another version of Hexaplast");
    return *static_cast<const FieldFileModule*>(symbol);
  }();
  return loaded;
}

}  // namespace

std::optional<Field> field_of(std::string_view word) {
  const auto found = std::ranges::find(kFields, word, &FieldEntry::word);
  if (found == kFields.end()) return std::nullopt;
  return found->field;
}

std::unique_ptr<FieldFile> make_field_file(const fs::path& file, Bodies bodies, FieldPlan plan) {
  return module_with_hdf5().make(file, std::move(bodies), std::move(plan));
}

std::vector<std::string> write_study_file(const fs::path& file, std::span<const fs::path> runs,
                                          std::span<const StudyColumn> columns, const NamedTexts& attributes) {
  return module_with_hdf5().write_study(file, runs, columns, attributes);
}

}  // namespace hexaplast::output
