#include "pbrt/cameras/aperture_image.h"

#include <cmath>
#include <functional>

namespace pbrt {

namespace {

const std::vector<std::string> kShapes = {"gaussian", "square", "pentagon", "star"};

constexpr int kResolution = 256;  // stock pbrt-v4's

/// Rasterises `value` over [-1, 1]^2, y up; row 0 is the bottom.
Image Draw(const std::function<Float(const Point2 &p)> &value) {
    Image image(PixelFormat::Float, {kResolution, kResolution}, {"Y"});
    for (int y = 0; y < kResolution; ++y)
        for (int x = 0; x < kResolution; ++x)
            image.Set({x, y}, 0, value((Point2(x, y) + Point2(0.5f)) * (Float(2) / kResolution) - Point2(1)));
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
    if (count > 1 && (image.FindChannel("R") < 0 || image.FindChannel("G") < 0 || image.FindChannel("B") < 0))
        throw UserError("\"{}\": an image of an aperture has one channel or R, G and B.", name);
    const Image source = count > 1 ? image.Select({"R", "G", "B"}) : image;
    const Point2i n = source.Resolution();
    Image mono(PixelFormat::Float, n, {"Y"});
    Float largest = 0;
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) {
            Float sum = 0;
            for (int c = 0; c < source.ChannelCount(); ++c) sum += source.Get({x, y}, c);
            if (!(sum >= 0 && std::isfinite(sum)))
                throw UserError("\"{}\": pixel ({}, {}) is negative, infinite or not a number.", name, x, y);
            largest = std::max(largest, sum);
            mono.Set({x, n.y - 1 - y}, 0, sum / Float(source.ChannelCount()));
        }
    if (!(largest > 0)) throw UserError("\"{}\" is black: no light passes this aperture.", name);
    return mono;
}

}  // namespace

ApertureImage::ApertureImage(Image image) : image_(std::move(image)) {
    const Point2i n = image_.Resolution();
    double sum = 0;
    Float reach2 = 0;
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) {
            const Float value = image_.Get({x, y}, 0);
            if (value == 0) continue;
            sum += double(value);
            // A pixel's support is one pixel from its centre in each direction.
            const Vector2 pixel = Float(2) / Vector2(n);
            const Vector2 corner =
                glm::min(glm::abs((Vector2(x, y) + Vector2(0.5f)) * pixel - Vector2(1)) + pixel, Vector2(1));
            reach2 = std::max(reach2, Sqr(corner.x) + Sqr(corner.y));
        }
    reach_ = std::sqrt(reach2);
    const double mean = sum / (double(n.x) * double(n.y));
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x)
            image_.Set({x, y}, 0, Float(double(image_.Get({x, y}, 0)) / mean * double(Pi / 4)));
}

ApertureImage ApertureImage::Read(const std::string &name, const FileResolver &files) {
    if (name.empty()) return {};
    if (std::find(kShapes.begin(), kShapes.end(), name) != kShapes.end()) return ApertureImage(DrawShape(name));
    const std::string path = files.Resolve(name);
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
        throw UserError("\"aperture\" \"{}\" is neither a file nor a built-in shape; {}.", name,
                        ListChoices(name, kShapes));
    return ApertureImage(Mono(ReadImage(path).image, path));
}

}  // namespace pbrt
