// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "hexaplast/geometry/plane_cut.hpp"

namespace hexaplast::output {

// Programs of the graphics driver, in the current context of OpenGL, and their uniforms.

/// Throws RendererUnavailable where the driver refuses it. common: text of both shaders.
unsigned linked(const std::string& common, const std::string& vertex, const std::string& fragment);

int place_of(unsigned program, const char* uniform);

void set(unsigned program, const char* uniform, const Eigen::Matrix4f& matrix);
void set(unsigned program, const char* uniform, const Eigen::Vector4f& vector);
void set(unsigned program, const char* uniform, float number);

/// What is drawn from now on is left out above the cut and outside the room.
void set_clips(unsigned program, const std::optional<Plane>& cut, const Eigen::AlignedBox3f& room);

}  // namespace hexaplast::output
