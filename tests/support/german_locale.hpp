// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <unistd.h>

#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <locale>
#include <string>

namespace hexaplast::support {

/// While it lives, C and C++ write 1.234,5 where they go by the locale, as in a host that has taken its user's. It is
/// made for the occasion, by localedef: few machines have it. Not for several threads.
class GermanLocale {
 public:
  GermanLocale() : before_(std::setlocale(LC_ALL, nullptr)), streams_before_(std::locale()) {
    std::locale::global(std::locale(streams_before_, new Numbers));
    const std::string make =
        "localedef -i de_DE -f UTF-8 '" + (directory_ / "de_DE.UTF-8").string() + "' > /dev/null 2>&1";
    std::filesystem::create_directories(directory_);
    if (std::system(make.c_str()) == 0) {
      ::setenv("LOCPATH", directory_.c_str(), 1);
      is_made_ = std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
    }
  }
  ~GermanLocale() {
    std::setlocale(LC_ALL, before_.c_str());
    std::locale::global(streams_before_);
    ::unsetenv("LOCPATH");
    std::filesystem::remove_all(directory_);
  }
  GermanLocale(const GermanLocale&) = delete;
  GermanLocale& operator=(const GermanLocale&) = delete;

  /// False where localedef or its sources are missing (Debian: locales): C then goes by its old locale.
  bool is_made() const { return is_made_; }

 private:
  struct Numbers : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };

  std::filesystem::path directory_ =
      std::filesystem::temp_directory_path() / ("hexaplast_locale_" + std::to_string(::getpid()));
  std::string before_;
  std::locale streams_before_;
  bool is_made_ = false;
};

}  // namespace hexaplast::support
