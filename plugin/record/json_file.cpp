// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/json_file.hpp"

#include <fstream>
#include <string>

#include "record/files.hpp"

namespace hexaplast::output {
namespace {

using Json = nlohmann::ordered_json;

/// Goes through a text without keeping any of it, up to the limits. A value costs up to 80 bytes of memory, however few
/// it takes in the file.
class InputValidator final : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return count(); }
  bool boolean(bool) override { return count(); }
  bool number_integer(number_integer_t) override { return count(); }
  bool number_unsigned(number_unsigned_t) override { return count(); }
  bool number_float(number_float_t, const string_t&) override { return count(); }
  bool string(string_t&) override { return count(); }
  bool binary(binary_t&) override { return count(); }
  bool key(string_t&) override { return true; }
  bool start_object(std::size_t) override { return open(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t, const std::string&, const Json::exception&) override { return false; }

  bool has_passed() const { return num_values_ <= kMaxValues && levels_ <= kMaxLevels; }

 private:
  bool count() {
    ++num_values_;
    return has_passed();
  }
  bool open() {
    ++levels_;
    return count();
  }
  bool close() {
    --levels_;
    return true;
  }

  static constexpr long kMaxValues = 1'000'000;
  static constexpr int kMaxLevels = 100;
  long num_values_ = 0;
  int levels_ = 0;
};

}  // namespace

nlohmann::ordered_json read_json(const std::filesystem::path& file) {
  require_readable(file);
  std::ifstream in(file);
  InputValidator validator;
  Json::sax_parse(in, &validator);  // what is wrong otherwise the parser says
  if (!validator.has_passed())
    throw Json::other_error::create(599, "more than a million values, or a hundred in one another", nullptr);
  in.clear();
  in.seekg(0);
  return Json::parse(in);
}

}  // namespace hexaplast::output
