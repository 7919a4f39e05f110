// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <utility>
#include <vector>

#include "hexaplast/base/error.hpp"
#include "hexaplast/material/material.hpp"

/// The library's enumerators by the words that scenes have for them.
namespace hexaplast::python {

template <class Enum>
using Words = std::vector<std::pair<const char*, Enum>>;

inline const Words<GradientScheme> kGradients = {
    {"blended", GradientScheme::kBlended}, {"vertex", GradientScheme::kVertex}, {"centre", GradientScheme::kCentre}};
inline const Words<YieldNorm> kYieldNorms = {
    {"vonMises", YieldNorm::kVonMises}, {"frobenius", YieldNorm::kFrobenius}, {"spectral", YieldNorm::kSpectral}};
inline const Words<RotationPlasticity> kRotations = {{"objective", RotationPlasticity::kObjective},
                                                     {"vertex", RotationPlasticity::kVertex},
                                                     {"centre", RotationPlasticity::kCentre},
                                                     {"none", RotationPlasticity::kNone}};
inline const Words<RotationFrame> kFrames = {{"bestFit", RotationFrame::kBestFit}, {"world", RotationFrame::kWorld}};
inline const Words<AveragingMethod> kAveragings = {{"gaussNewton", AveragingMethod::kGaussNewton},
                                                   {"gaussNewtonIsolated", AveragingMethod::kGaussNewtonIsolated},
                                                   {"localGlobal", AveragingMethod::kLocalGlobal},
                                                   {"jacobi", AveragingMethod::kJacobi}};
inline const Words<Precision> kPrecisions = {{"double", Precision::kDouble}, {"mixed", Precision::kMixed}};

template <class Enum>
std::string word(const Words<Enum>& words, Enum value) {
  for (const auto& [name, meant] : words)
    if (meant == value) return name;
  return {};  // every enumerator has its word
}

/// Throws InputError that names the words that are allowed.
template <class Enum>
Enum meaning(const Words<Enum>& words, const char* what, const std::string& text) {
  std::vector<const char*> names;
  for (const auto& [name, meant] : words) {
    if (name == text) return meant;
    names.push_back(name);
  }
  throw InputError(fmt::format("{} = '{}' must be one of {}", what, text, fmt::join(names, ", ")));
}

}  // namespace hexaplast::python
