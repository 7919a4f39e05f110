// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sofa/helper/visual/DrawTool.h>

#include <vector>

namespace hexaplast::sofa_plugin::test
{

/// Keeps the triangles, lines, points and round shapes that a component draws in SOFA, and counts all other drawing.
class RecordingDrawTool final : public sofa::helper::visual::DrawTool
{
public:
    using Points = const std::vector<Vec3>&;
    using Colours = const std::vector<RGBAColor>&;
    using Triples = const std::vector<Vec3i>&;
    using Pairs = const std::vector<Vec2i>&;
    using Sizes = const std::vector<float>&;
    using Place = const Vec3&;
    using Colour = const RGBAColor&;

    std::vector<Vec3> corners;       ///< [m] of triangles, three after three
    std::vector<RGBAColor> colours;  ///< of the corners
    std::vector<Vec3> ends;          ///< [m] of lines, two after two
    std::vector<Vec3> points;        ///< [m]
    int num_others = 0;              ///< calls that draw or change something else
    int num_open_states = 0;         ///< saved and not restored
    bool is_lit = false, is_wireframe = false;

    void drawTriangles(Points points, Colours colours_of_points) override
    {
        corners.insert(corners.end(), points.begin(), points.end());
        colours.insert(colours.end(), colours_of_points.begin(), colours_of_points.end());
    }
    void drawLines(Points points, float, Colour) override { ends.insert(ends.end(), points.begin(), points.end()); }
    void saveLastState() override { ++num_open_states; }
    void restoreLastState() override { --num_open_states; }
    void enableLighting() override { is_lit = true; }
    void setPolygonMode(int, bool wireframe) override { is_wireframe = wireframe; }

    void init() override {}
    // without override: releases of SOFA differ in the last argument
    void drawInfiniteLine(Place, Place, Colour) { ++num_others; }
    void drawInfiniteLine(Place, Place, const float&, Colour) { ++num_others; }
    void drawInfiniteLine(Place, Place, Colour, const bool&) { ++num_others; }
    void drawInfiniteLine(Place, Place, const float&, Colour, const bool&) { ++num_others; }
    void drawPoints(Points places, float, Colour) override
    {
        points.insert(points.end(), places.begin(), places.end());
    }
    void drawPoints(Points, float, Colours) override { ++num_others; }
    void drawLine(Place, Place, Colour) override { ++num_others; }
    void drawLines(Points, float, Colours) override { ++num_others; }
    void drawLines(Points, Pairs, float, Colour) override { ++num_others; }
    void drawLineStrip(Points, float, Colour) override { ++num_others; }
    void drawLineStrip(Points, float, Colours) { ++num_others; }  // without override: since v26.12
    void drawLineLoop(Points, float, Colour) override { ++num_others; }
    void drawDisk(float, double, double, int, Colour) override { ++num_others; }
    void drawCircle(float, float, int, Colour) override { ++num_others; }
    void drawTriangles(Points places, Colour) override { corners.insert(corners.end(), places.begin(), places.end()); }
    void drawTriangles(Points, Place, Colour) override { ++num_others; }
    void drawTriangles(Points, Triples, Points, Colour) override { ++num_others; }
    void drawTriangles(Points, Triples, Points, Colours) override { ++num_others; }
    void drawTriangles(Points, Points, Colours) override { ++num_others; }
    void drawTriangleStrip(Points, Points, Colour) override { ++num_others; }
    void drawTriangleFan(Points, Points, Colour) override { ++num_others; }
    void drawFrame(Place, const Quaternion&, const Vec3f&) override { ++num_others; }
    void drawFrame(Place, const Quaternion&, const Vec3f&, Colour) override { ++num_others; }
    void drawSpheres(Points, Sizes, Colour) override { ++num_others; }
    void drawSpheres(Points, float, Colour) override { ++num_others; }
    void drawFakeSpheres(Points, Sizes, Colour) override { ++num_others; }
    void drawFakeSpheres(Points, float, Colour) override { ++num_others; }
    void drawCone(Place, Place, float, float, Colour, int) override { ++num_others; }
    void drawCube(const float&, Colour, const int&) override { ++num_others; }
    void drawCylinder(Place, Place, float, Colour, int) override { ++num_others; }
    void drawCapsule(Place, Place, float, Colour, int) override { ++num_others; }
    void drawArrow(Place, Place, float, Colour, int) override { ++num_others; }
    void drawArrow(Place, Place, float, float, Colour, int) override { ++num_others; }
    void drawArrow(Place, Place, float, float, float, Colour, int) override { ++num_others; }
    void drawCross(Place, float, Colour) override { ++num_others; }
    void drawPlus(const float&, Colour, const int&) override { ++num_others; }
    void drawPoint(Place, Colour) override { ++num_others; }
    void drawPoint(Place, Place, Colour) override { ++num_others; }
    void drawTriangle(Place, Place, Place, Place) override { ++num_others; }
    void drawTriangle(Place, Place, Place, Place, Colour) override { ++num_others; }
    void drawTriangle(Place, Place, Place, Place, Colour, Colour, Colour) override { ++num_others; }
    void drawTriangle(Place, Place, Place, Place, Place, Place, Colour, Colour, Colour) override { ++num_others; }
    void drawQuad(Place, Place, Place, Place, Place) override { ++num_others; }
    void drawQuad(Place, Place, Place, Place, Place, Colour) override { ++num_others; }
    void drawQuad(Place, Place, Place, Place, Place, Colour, Colour, Colour, Colour) override { ++num_others; }
    void drawQuad(Place, Place, Place, Place, Place, Place, Place, Place, Colour, Colour, Colour, Colour) override
    {
        ++num_others;
    }
    void drawQuads(Points, Colour) override { ++num_others; }
    void drawQuads(Points, Colours) override { ++num_others; }
    void drawTetrahedron(Place, Place, Place, Place, Colour) override { ++num_others; }
    void drawScaledTetrahedron(Place, Place, Place, Place, Colour, float) override { ++num_others; }
    void drawTetrahedra(Points, Colour) override { ++num_others; }
    void drawScaledTetrahedra(Points, Colour, float) override { ++num_others; }
    void drawHexahedron(Place, Place, Place, Place, Place, Place, Place, Place, Colour) override { ++num_others; }
    void drawHexahedra(Points, Colour) override { ++num_others; }
    void drawScaledHexahedra(Points, Colour, float) override { ++num_others; }
    void drawSphere(Place, float) override { ++num_others; }
    void drawSphere(Place, float, Colour) override { ++num_others; }
    void drawEllipsoid(Place, Place) override { ++num_others; }
    void drawBoundingBox(Place, Place, float) override { ++num_others; }
    void draw3DText(Place, float, Colour, const char*) override { ++num_others; }
    void draw3DText_Indices(Points, float, Colour) override { ++num_others; }
    void pushMatrix() override { ++num_others; }
    void popMatrix() override { ++num_others; }
    void multMatrix(float*) override { ++num_others; }
    void scale(float) override { ++num_others; }
    void translate(float, float, float) override { ++num_others; }
    void setMaterial(Colour) override { ++num_others; }
    void resetMaterial(Colour) override { ++num_others; }
    void resetMaterial() override { ++num_others; }
    void setLightingEnabled(bool) override { ++num_others; }
    void enableBlending() override { ++num_others; }
    void disableBlending() override { ++num_others; }
    void disableLighting() override { is_lit = false; }
    void enableDepthTest() override { ++num_others; }
    void disableDepthTest() override { ++num_others; }
    void writeOverlayText(int, int, unsigned, Colour, const char*) override { ++num_others; }
    void enablePolygonOffset(float, float) override { ++num_others; }
    void disablePolygonOffset() override { ++num_others; }
    void readPixels(int, int, int, int, float*, float*) override { ++num_others; }
};

}  // namespace hexaplast::sofa_plugin::test
