// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace hexaplast::support {

/// The classes of the elements in a piece of XML, in their order.
inline std::vector<std::string> classes_in(const std::string& xml) {
  std::vector<std::string> classes;
  static const std::regex opening("<([A-Z][A-Za-z0-9]*)");
  for (std::sregex_iterator match(xml.begin(), xml.end(), opening), end; match != end; ++match)
    classes.push_back((*match)[1]);
  return classes;
}

/// What a component is the only one of, as the page says it; empty: there may be several.
inline std::string place_of(const std::string& class_name, const std::map<std::string, std::string>& category_of) {
  static const std::set<std::string> kSingle = {"AnimationLoop", "OdeSolver", "LinearSolver",
                                                "Topology",      "Mass",      "MechanicalState"};
  if (class_name.starts_with("Hexahedron") && class_name.ends_with("FEMForceField")) return "body";
  if (class_name == "RunSettings") return class_name;
  const auto category = category_of.find(class_name);
  return category != category_of.end() && kSingle.count(category->second) ? category->second : "";
}

/// The scene of docs/components.md with an example pasted in, as the page says.
inline std::string pasted(const std::string& scene, const std::string& example,
                          const std::map<std::string, std::string>& category_of) {
  std::set<std::string> taken;
  std::istringstream example_lines(example);  // what is indented stands in a node of its own and takes no place here
  for (std::string line; std::getline(example_lines, line);)
    if (line.starts_with('<'))
      for (const std::string& class_name : classes_in(line)) taken.insert(place_of(class_name, category_of));
  taken.erase("");
  std::string result;
  bool is_pasted = false;
  const auto paste = [&] {
    if (!is_pasted) result += example + "\n";
    is_pasted = true;
  };
  std::istringstream lines(scene);
  for (std::string line; std::getline(lines, line);) {
    const std::vector<std::string> classes = classes_in(line);
    const bool is_replaced = !classes.empty() && taken.count(place_of(classes[0], category_of));
    if (is_replaced || line == "  </Node>") paste();
    if (!is_replaced) result += line + "\n";
  }
  return result;
}

}  // namespace hexaplast::support
