// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// What writes files during a run. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kVTKExporterAttributes[] = {
    {.name = "filename",
     .type = Type::kText,
     .help = "Where to write, below the directory of the run; default: the component's name. A number from 0 on and "
             ".vtu are added."},
    {.name = "exportEveryNumberOfSteps",
     .type = Type::kInteger,
     .initial = "0",
     .range = {.min = 0, .max = 1e9},
     .help = "Number of steps between two files; 0: none."},
    {.name = "exportAtBegin", .type = Type::kBool, .initial = "false", .help = "Also writes before the first step."},
    {.name = "exportAtEnd",
     .type = Type::kWord,
     .initial = "false",
     .words = "false 0",
     .help = "Only false here: choose exportEveryNumberOfSteps such that it divides the steps."},
    {.name = "overwrite",
     .type = Type::kBool,
     .initial = "false",
     .help = "Writes the same file again and again, without a number."},
    {.name = "enable", .type = Type::kBool, .initial = "true", .help = "Whether it writes at all."},
    {.name = "XMLformat",
     .type = Type::kWord,
     .initial = "true",
     .words = "true 1",
     .help = "Only true here: files are .vtu, as text, with all digits."},
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Points; default: those of the mechanical state of the node, or of the nearest one above."},
    {.name = "edges", .type = Type::kBool, .initial = "true", .help = "Writes the edges of the topology."},
    {.name = "triangles", .type = Type::kBool, .initial = "false", .help = "Writes its triangles."},
    {.name = "quads", .type = Type::kBool, .initial = "false", .help = "Writes its quads."},
    {.name = "hexas", .type = Type::kBool, .initial = "false", .help = "Writes its hexahedra."},
    ignored_attribute("tetras", "Ignored here: there are none."),
    {.name = "pointsDataFields",
     .type = Type::kText,
     .help =
         "Attributes to write with the points, separated by blanks: path.attribute, or name=path.attribute. One number "
         "or three per point."},
    {.name = "cellsDataFields",
     .type = Type::kText,
     .help = "The same with the cells, in the order edges, triangles, quads, hexahedra."},
};
inline constexpr Description kVTKExporter{
    .class_name = "VTKExporter",
    .category = "Exporter",
    .help =
        "Writes the nodes and cells of its node as VTK files during the run. Cells of removed hexahedra are omitted, "
        "also those of surfaces that follow a body; the points stay.",
    .attributes = kVTKExporterAttributes};

inline constexpr Attribute kWriteStateAttributes[] = {
    {.name = "filename", .type = Type::kText, .help = "Where to write, below the directory of the run."},
    {.name = "writeX", .type = Type::kBool, .initial = "true", .help = "Writes positions."},
    {.name = "writeX0", .type = Type::kBool, .initial = "false", .help = "Writes rest positions."},
    {.name = "writeV", .type = Type::kBool, .initial = "false", .help = "Writes velocities."},
    {.name = "writeF",
     .type = Type::kWord,
     .initial = "false",
     .words = "false 0",
     .help = "Only false here: forces are not kept."},
    {.name = "time",
     .type = Type::kReals,
     .unit = "s",
     .range = kNotNegative,
     .help = "When to write, ascending; with period, when to begin. Without both, before every step."},
    {.name = "period", .type = Type::kReal, .unit = "s", .range = kPositive, .help = "Time between two states."},
};
inline constexpr Description kWriteState{
    .class_name = "WriteState",
    .category = "Exporter",
    .help =
        "Writes the state of its node as text, all digits: lines T= time, then X=, X0=, V= with three numbers per "
        "node. "
        "A state is written at the beginning of a step, as in SOFA: the one after the last step is missing.",
    .attributes = kWriteStateAttributes};

}  // namespace hexaplast::attributes
