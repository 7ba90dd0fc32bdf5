#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "pbrt/cameras/camera_kinds.h"
#include "pbrt/math/rng.h"

namespace pbrt::test {

/// Two singlets around a stop, as in the conformance suite: 50 mm, focused at about 6 m.
inline std::vector<LensElement> DoubleGauss() {
    return {{0.058f, 0.007f, 1.6f, 0.015f},
            {-0.21f, 0.005f, 1, 0.015f},
            {0, 0.005f, 1, 0.007f},
            {0.21f, 0.007f, 1.6f, 0.015f},
            {-0.058f, 0.042f, 1, 0.015f}};
}

/// A lens with a strong negative front element, which bends rays and vignettes a lot.
inline std::vector<LensElement> FishEye() {
    return {{0.06f, 0.002f, 1.6f, 0.025f}, {0.018f, 0.02f, 1, 0.016f}, {0.04f, 0.006f, 1.7f, 0.009f},
            {-0.04f, 0.001f, 1, 0.009f},   {0, 0.001f, 1, 0.004f},     {0.05f, 0.005f, 1.5f, 0.008f},
            {-0.03f, 0.035f, 1, 0.008f}};
}

/// A lens as thin as one of this size can be; the focal length, in metres, is negative for a diverging lens.
inline std::vector<LensElement> ThinLens(Float focalLength, Float apertureRadius) {
    const Float radius = focalLength;  // two equal surfaces of index 1.5
    const Float thickness = 1.05f * apertureRadius * apertureRadius / std::abs(radius);
    return {{radius, thickness, 1.5f, apertureRadius}, {-radius, 0.05f, 1, apertureRadius}};
}

inline Ray FromFilm(const Point2 &film, const Point2 &rear, const LensSystem &lens) {
    return {Point3(film, 0), Normalize(Point3(rear, lens.RearZ()) - Point3(film, 0))};
}
/// In the square [-half, half)^2.
inline Point2 RandomInSquare(Rng &rng, Float half) { return (rng.Uniform2() - Point2(0.5f)) * (2 * half); }

/// Writes a temporary file of this process; it is removed when the process ends.
inline std::string WriteFile(const std::string &name, const std::string &text) {
    struct Files : std::set<std::string> {
        ~Files() {
            for (const std::string &path : *this) std::remove(path.c_str());
        }
    };
    static Files files;
    const std::string path = testing::TempDir() + std::to_string(getpid()) + "_" + name;
    files.insert(path);
    std::ofstream(path) << text;
    return path;
}

}  // namespace pbrt::test
