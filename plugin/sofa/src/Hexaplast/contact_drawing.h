// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/fields.h>
#include <sofa/core/visual/VisualParams.h>

#include <algorithm>

#include "hexaplast/contact/contact_terms.hpp"

namespace hexaplast::sofa_plugin
{

inline constexpr float kContactPointSize = 5, kContactForceWidth = 2;  // [pixels]
inline constexpr double kLongestForce = 0.1;                           // of the body's size

/// The points that touch, red where they slip, and the forces on the first body as lines from there. scale: [m/N]; 0:
/// so that the greatest force is a tenth of the body's size.
inline void drawContactTerms(sofa::helper::visual::DrawTool& tool, const ContactTerms& contacts,
                             const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, double scale)
{
    if (contacts.empty() || x.first.rows() == 0) return;
    std::vector<Vec3> forces;
    double greatest = 0;
    for (const ContactTerm& term : contacts.terms)
    {
        forces.push_back(term.force(term.at(x), term.at(v)));
        greatest = std::max(greatest, forces.back().norm());
    }
    const Vec3 extent = (x.first.colwise().maxCoeff() - x.first.colwise().minCoeff()).transpose();
    if (scale == 0 && greatest > 0) scale = kLongestForce * extent.norm() / greatest;

    std::vector<sofa::type::Vec3> stick, slip, ends;
    for (std::size_t i = 0; i < forces.size(); ++i)
    {
        const Vec3 place = contacts.terms[i].place_on_first(x.first);
        (contacts.terms[i].slips ? slip : stick).push_back(vec3(place));
        ends.push_back(vec3(place));
        ends.push_back(vec3(Vec3(place + scale * forces[i])));
    }
    tool.disableLighting();
    if (!stick.empty()) tool.drawPoints(stick, kContactPointSize, sofa::type::RGBAColor::green());
    if (!slip.empty()) tool.drawPoints(slip, kContactPointSize, sofa::type::RGBAColor::red());
    tool.drawLines(ends, kContactForceWidth, sofa::type::RGBAColor::yellow());
}

}  // namespace hexaplast::sofa_plugin
