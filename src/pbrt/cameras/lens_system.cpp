#include <cmath>
#include <functional>

#include "pbrt/cameras/camera_kinds.h"

#include "pbrt/core/files.h"

namespace pbrt {
namespace {

const std::vector<std::string> kShapes = {"gaussian", "square", "pentagon", "star"};

constexpr int kResolution = 256;  // stock pbrt-v4's

/// Rasterises `value` over [-1, 1]^2, y up; row 0 is the bottom.
Image Draw(const std::function<Float(const Point2 &p)> &value) {
    Image image(PixelFormat::Float, {kResolution, kResolution}, {"Y"});
    ForEachPixel(image, [&](Point2i p) {
        image.Set(p, 0, value((Point2(p) + Point2(0.5f)) * (Float(2) / kResolution) - Point2(1)));
    });
    return image;
}

/// Star-shaped polygon: corners at equal angles from `firstAngle` (radians), with alternating radii `a` and `b`.
Image DrawPolygon(int corners, Float firstAngle, Float a, Float b) {
    const Float step = 2 * Pi / Float(corners);
    auto corner = [&](int i) {
        const Float angle = firstAngle + Float(i) * step;
        return Point2(std::cos(angle), std::sin(angle)) * (i % 2 ? b : a);
    };
    return Draw([&](const Point2 &p) {
        for (int i = 0; i < corners; ++i) {
            // p is inside a triangle of two corners and the centre if it is a positive combination of the corners with
            // sum at most 1.
            const Point2 u = corner(i), v = corner(i + 1);
            const Float area = u.x * v.y - u.y * v.x, s = (p.x * v.y - p.y * v.x) / area,
                        t = (u.x * p.y - u.y * p.x) / area;
            if (s >= 0 && t >= 0 && s + t <= 1) return Float(1);
        }
        return Float(0);
    });
}

/// One of kShapes, in the size and orientation of stock pbrt-v4.
Image DrawShape(const std::string &shape) {
    if (shape == "gaussian")
        return Draw(
            [](const Point2 &p) { return std::max(std::exp(-(Sqr(p.x) + Sqr(p.y))) - std::exp(Float(-1)), Float(0)); });
    if (shape == "square")
        return Draw([](const Point2 &p) { return Float(std::abs(p.x) < 0.5f && std::abs(p.y) < 0.5f ? 1 : 0); });
    if (shape == "pentagon") return DrawPolygon(5, -Pi / 2, Float(0.8), Float(0.8));
    return DrawPolygon(10, 0, std::cos(Radians(72)) / std::cos(Radians(36)), 1);
}

/// Mean of R, G, B, or the only channel; flipped, so that row 0 is the bottom.
Image Mono(const Image &image, const std::string &name) {
    const int count = image.ChannelCount();
    if (count > 1 && !image.HasRgb())
        throw UserError("\"{}\": an image of an aperture has one channel or R, G and B.", name);
    const Image source = count > 1 ? image.Select({"R", "G", "B"}) : image;
    const Point2i n = source.Resolution();
    Image mono(PixelFormat::Float, n, {"Y"});
    Float largest = 0;
    ForEachPixel(source, [&](Point2i p) {
        Float sum = 0;
        for (int c = 0; c < source.ChannelCount(); ++c) sum += source.Get(p, c);
        if (!(sum >= 0 && std::isfinite(sum)))
            throw UserError("\"{}\": pixel ({}, {}) is negative, infinite or not a number.", name, p.x, p.y);
        largest = std::max(largest, sum);
        mono.Set({p.x, n.y - 1 - p.y}, 0, sum / Float(source.ChannelCount()));
    });
    if (!(largest > 0)) throw UserError("\"{}\" is black: no light passes this aperture.", name);
    return mono;
}

/// Paraxial ray entering parallel to the axis at height 1: height and slope behind the lens.
struct Traced {
    double height, slope;
};

Traced TraceParallelRay(std::span<const LensElement> elements, bool isFromScene) {
    double y = 1, u = 0;
    for (size_t k = 0; k < elements.size(); ++k) {
        const size_t i = isFromScene ? k : elements.size() - 1 - k;
        const LensElement &e = elements[i];
        // Along the light; radius above 0: convex towards it.
        double radius = double(e.curvatureRadius), before = i > 0 ? double(elements[i - 1].index) : 1,
               after = double(e.index), thickness = double(e.thickness);
        if (!isFromScene) {
            radius = -radius;
            std::swap(before, after);
            thickness = i > 0 ? double(elements[i - 1].thickness) : 0;
        }
        if (radius != 0) u = (before * u - y * (after - before) / radius) / after;
        if (k + 1 < elements.size()) y += thickness * u;
    }
    return {y, u};
}

}  // namespace

ApertureImage::ApertureImage(Image image) : image_(std::move(image)) {
    const Point2i n = image_.Resolution();
    double sum = 0;
    Float reach2 = 0;
    ForEachPixel(image_, [&](Point2i p) {
        const Float value = image_.Get(p, 0);
        if (value == 0) return;
        sum += double(value);
        // A pixel's support is one pixel from its centre in each direction.
        const Vector2 pixel = Float(2) / Vector2(n);
        const Vector2 corner =
            glm::min(glm::abs((Vector2(p) + Vector2(0.5f)) * pixel - Vector2(1)) + pixel, Vector2(1));
        reach2 = std::max(reach2, Sqr(corner.x) + Sqr(corner.y));
    });
    reach_ = std::sqrt(reach2);
    const double mean = sum / (double(n.x) * double(n.y));
    ForEachPixel(image_, [&](Point2i p) { image_.Set(p, 0, Float(double(image_.Get(p, 0)) / mean * double(Pi / 4))); });
}

ApertureImage ApertureImage::Read(const std::string &name, const FileResolver &files) {
    if (name.empty()) return {};
    if (std::find(kShapes.begin(), kShapes.end(), name) != kShapes.end()) return ApertureImage(DrawShape(name));
    const std::string path = files.Resolve(name);
    if (!FileExists(path))
        throw UserError("\"aperture\" \"{}\" is neither a file nor a built-in shape; {}.", name,
                        ListChoices(name, kShapes));
    return ApertureImage(Mono(ReadImage(path).image, path));
}

std::vector<LensElement> ReadLensFile(const std::string &path) {
    const std::vector<Float> v = ReadNumberFile(path);
    if (v.empty() || v.size() % 4 != 0)
        throw UserError(
            "{}: a lens file holds four numbers per element (curvature radius, thickness, "
            "index of refraction, aperture diameter); found {} numbers.",
            path, v.size());
    std::vector<LensElement> elements;
    for (size_t i = 0; i < v.size(); i += 4) {
        constexpr Float kMillimetre = 0.001f;
        LensElement e{v[i] * kMillimetre, v[i + 1] * kMillimetre, v[i + 2], v[i + 3] / 2 * kMillimetre};
        auto complain = [&](const char *what, Float value) {
            throw UserError("{}: element {}: the {} is {}.", path, i / 4 + 1, what, value);
        };
        if (!(e.thickness >= 0)) complain("thickness", v[i + 1]);
        if (e.IsStop() && e.index == 0) e.index = 1;
        if (!(e.index > 0)) complain("index of refraction", e.index);
        if (!(e.apertureRadius > 0)) complain("aperture diameter", v[i + 3]);
        elements.push_back(e);
    }
    return elements;
}

CardinalPoints ComputeCardinalPoints(std::span<const LensElement> elements) {
    const Traced behind = TraceParallelRay(elements, true), before = TraceParallelRay(elements, false);
    // The outgoing ray, extended back, has its initial height at the principal plane; the focal point lies a focal
    // length behind it.
    return {.focalLength = -1 / behind.slope,
            .rearPrincipal = (behind.height - 1) / behind.slope,
            .frontPrincipal = (before.height - 1) / before.slope};
}

std::optional<double> FocusedThickness(std::span<const LensElement> elements, double distance) {
    const CardinalPoints p = ComputeCardinalPoints(elements);
    if (!(p.focalLength > 0) || !std::isfinite(p.focalLength)) return {};
    double length = 0;
    for (size_t i = 0; i + 1 < elements.size(); ++i) length += double(elements[i].thickness);
    // Film and scene distances s and t from the principal planes: 1/s + 1/t = 1/f, s + t = the rest of `distance`. Of
    // two solutions, takes the film closer to the focal point.
    const double sum = distance - (length - p.frontPrincipal - p.rearPrincipal);
    const double root = sum * (sum - 4 * p.focalLength);
    if (!(sum > 0) || !(root >= 0)) return {};
    const double thickness = (sum - std::sqrt(root)) / 2 - p.rearPrincipal;
    if (!(thickness > 0)) return {};
    return thickness;
}

LensSystem::LensSystem(std::span<const LensElement> elements, const ApertureImage &aperture) : aperture_(aperture) {
    PBRT_CHECK(!elements.empty());
    double z = 0;
    for (size_t i = elements.size(); i-- > 0;) {
        const LensElement &e = elements[i];
        z += double(e.thickness);
        const Float indexInFront = i > 0 ? elements[i - 1].index : 1;
        surfaces_.push_back(
            {e.IsStop() ? 0 : 1 / e.curvatureRadius, Float(z), e.apertureRadius, e.index / indexInFront});
    }
}

Float LensSystem::Trace(Ray *ray) const {
    Float weight = 1;
    Point3 p = ray->o;
    Vector3 d = ray->d;
    for (const Surface &s : surfaces_) {
        p.z -= s.z;
        const bool isStop = s.curvature == 0;
        // Surface relative to its vertex: c |p|^2 + 2 z = 0. Along the ray c t^2 + 2 b t + a = 0; the root on this side
        // of the sphere has cosine sqrt(b^2 - c a) with the normal.
        const Float a = s.curvature * LengthSquared(p) + 2 * p.z, b = s.curvature * Dot(p, d) + d.z;
        const Float cosine2 = b * b - s.curvature * a;
        if (!(cosine2 > 0)) return 0;
        const Float cosine = std::sqrt(cosine2);
        const Float t = b >= 0 ? -a / (b + cosine) : (cosine - b) / s.curvature;
        if (!(t >= 0)) return 0;
        p += d * t;
        if (isStop) {
            if (aperture_) {
                weight *= aperture_.Lookup({p.x / s.apertureRadius, p.y / s.apertureRadius});
                if (weight == 0) return 0;
            } else if (Sqr(p.x) + Sqr(p.y) > Sqr(s.apertureRadius)) return 0;
        } else {
            if (Sqr(p.x) + Sqr(p.y) > Sqr(s.apertureRadius)) return 0;
            const Vector3 n(s.curvature * p.x, s.curvature * p.y, s.curvature * p.z + 1);
            const Float refracted2 = 1 - Sqr(s.relativeIndex) * (1 - cosine2);
            if (!(refracted2 > 0)) return 0;
            d = d * s.relativeIndex + n * (std::sqrt(refracted2) - s.relativeIndex * cosine);
        }
        p.z += s.z;
    }
    ray->o = p;
    ray->d = Normalize(d);
    return weight;
}

}  // namespace pbrt
