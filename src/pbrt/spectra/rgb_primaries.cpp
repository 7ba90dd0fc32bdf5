#include "pbrt/spectra/rgb_primaries.h"

namespace pbrt {

std::span<const RgbPrimaries> KnownRgbPrimaries() {
    static const std::array<RgbPrimaries, 4> spaces = {{
        {"srgb", {0.64f, 0.33f}, {0.3f, 0.6f}, {0.15f, 0.06f}, "stdillum-D65"},
        {"dci-p3", {0.68f, 0.32f}, {0.265f, 0.69f}, {0.15f, 0.06f}, "stdillum-D65"},
        {"rec2020", {0.708f, 0.292f}, {0.17f, 0.797f}, {0.131f, 0.046f}, "stdillum-D65"},
        {"aces2065-1", {0.7347f, 0.2653f}, {0, 1}, {0.0001f, -0.077f}, "illum-acesD60"},
    }};
    return spaces;
}

Point2 Chromaticity(const Vector3 &xyz) {
    Float sum = xyz.x + xyz.y + xyz.z;
    return {xyz.x / sum, xyz.y / sum};
}

Vector3 XyzFromChromaticity(const Point2 &xy) {
    if (xy.y == 0) return {0, 0, 0};
    return {xy.x / xy.y, 1, (1 - xy.x - xy.y) / xy.y};
}

glm::mat3 ComputeXyzFromRgb(const Point2 &r, const Point2 &g, const Point2 &b, const Vector3 &white) {
    auto primary = [](const Point2 &p) { return glm::dvec3(p.x, p.y, 1.0 - double(p.x) - double(p.y)); };
    glm::dmat3 primaries(primary(r), primary(g), primary(b));
    glm::dvec3 scale = glm::inverse(primaries) * glm::dvec3(white);
    return glm::mat3(glm::dmat3(primaries[0] * scale.x, primaries[1] * scale.y, primaries[2] * scale.z));
}

}  // namespace pbrt
