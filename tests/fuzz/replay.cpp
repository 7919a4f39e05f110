// SPDX-License-Identifier: LGPL-2.1-or-later
// replay CORPUS COUNT: gives a target every file of a folder and COUNT mutations of each, the same in every run. Takes
// the place of libFuzzer where there is none.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <vector>

#include "target.hpp"

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

namespace {

void mutate(Bytes& bytes, std::mt19937& random) {
  const auto below = [&](std::size_t bound) {
    return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
  };
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    const std::size_t at = below(bytes.size() + 1);
    const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    switch (below(4)) {
      case 0:
        bytes.insert(place, static_cast<std::uint8_t>(below(256)));
        break;
      case 1:
        if (at < bytes.size()) *place = static_cast<std::uint8_t>(below(256));
        break;
      case 2:
        bytes.erase(place, place + static_cast<std::ptrdiff_t>(std::min(below(20), bytes.size() - at)));
        break;
      default: {  // a piece of itself, somewhere else
        const std::size_t from = below(bytes.size() + 1), length = std::min(below(20), bytes.size() - from);
        const Bytes piece(bytes.begin() + static_cast<std::ptrdiff_t>(from),
                          bytes.begin() + static_cast<std::ptrdiff_t>(from + length));
        bytes.insert(place, piece.begin(), piece.end());
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: " << argv[0] << " CORPUS COUNT\n";
    return 2;
  }
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(argv[1])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) {
    std::cerr << argv[1] << " holds no files\n";
    return 1;
  }
  std::mt19937 random(20261121);
  long inputs = 0;
  for (const fs::path& path : files) {
    std::ifstream file(path, std::ios::binary);
    const Bytes whole{std::istreambuf_iterator<char>(file), {}};
    for (long k = 0; k <= std::atol(argv[2]); ++k, ++inputs) {
      Bytes bytes = whole;
      if (k > 0) mutate(bytes, random);
      LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    }
  }
  std::cout << inputs << " inputs\n";
}
