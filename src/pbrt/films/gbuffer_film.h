#pragma once
#include <array>

#include "pbrt/films/rgb_film.h"

namespace pbrt {

struct GBufferParams : FilmParams {
    enum class Space { Camera, World };
    static constexpr NamedValue<Space> kSpaces[] = {{"camera", Space::Camera}, {"world", Space::World}};
    Space space = Space::Camera;
    void Describe(auto &&v) {
        FilmParams::Describe(v);
        v("coordinatesystem", space, kSpaces, "space of positions and normals");
    }
};

/// The `gbuffer` film: RGB (with splats), mean visible-surface data per pixel, and the variance of samples with a hit.
class GBufferFilm final : public RgbFilm {
  public:
    GBufferFilm(const GBufferParams &params, const ParamSet &set, const FilmRequest &request)
        : RgbFilm("gbuffer", params, set, request, kFurtherChannels.size() * sizeof(float) + sizeof(Surface)),
          renderFromOutput_(params.space == GBufferParams::Space::Camera
                                ? request.context.renderFromCamera
                                : AnimatedTransform(request.context.renderFromWorld)),
          surfaces_(Frame().PixelCount()) {}

    bool NeedsVisibleSurface() const override { return true; }
    void AddSample(const FilmSample &sample) override {
        const std::optional<Vector3> sensor = AddColor(sample);
        if (!sensor) return;
        Surface &surface = surfaces_[Frame().IndexOf(sample.pixel)];
        const double w = double(sample.weight);
        if (sample.hasRay) surface.sums[Surface::kRayWeight].Add(w);
        if (!sample.visible) return;
        const VisibleSurface &visible = *sample.visible;
        const Transform outputFromRender = renderFromOutput_.At(visible.time).Inverse();
        auto depth = [&](const Vector3 &v) { return std::abs(outputFromRender.Vector(v).z); };
        const glm::dvec3 measured(*sensor);
        surface.Add(Surface::kSensor, 1, measured);
        surface.Add(Surface::kSquares, 1, measured * measured);
        ++surface.count;
        surface.sums[Surface::kWeight].Add(w);
        surface.Add(Surface::kP, w, outputFromRender.Point(visible.p));
        surface.Add(Surface::kN, w, Normalize(outputFromRender.Normal(visible.n)));
        surface.Add(Surface::kNs, w, Normalize(outputFromRender.Normal(visible.ns)));
        surface.Add(Surface::kUv, w, visible.uv);
        surface.Add(Surface::kDz, w, Vector2(depth(visible.dpdx), depth(visible.dpdy)));
        surface.Add(Surface::kAlbedo, w, AlbedoColor(visible, OutputSpace()));
    }
    /// The channels of pbrt-v4-format §14.
    Image ToImage() const override {
        Image image = MakeImage({kFurtherChannels.begin(), kFurtherChannels.end()});
        const Surface *next = surfaces_.data();
        ForEachPixel(image, [&](Point2i p) {
            const Surface &surface = *next++;
            const auto &sums = surface.sums;
            const double weight = sums[Surface::kRayWeight].Value(), seenWeight = sums[Surface::kWeight].Value(),
                         seen = seenWeight != 0 ? 1 / seenWeight : 0;
            int channel = 3;
            auto put = [&](double v) { image.Set(p, channel++, Float(v)); };
            auto put3 = [&](const glm::dvec3 &v) {
                for (int c = 0; c < 3; ++c) put(v[c]);
            };
            auto putMeans = [&](size_t first, size_t count) {
                for (size_t i = first; i < first + count; ++i) put(sums[i].Value() * seen);
            };
            // Albedo counts rays without a hit as black; geometry excludes them.
            for (size_t c = 0; c < 3; ++c) put(weight != 0 ? sums[Surface::kAlbedo + c].Value() / weight : 0);
            putMeans(Surface::kP, 3);
            putMeans(Surface::kDz, 2);
            for (const size_t n : {Surface::kN, Surface::kNs})
                put3(UnitOrZero({sums[n].Value(), sums[n + 1].Value(), sums[n + 2].Value()}));
            putMeans(Surface::kUv, 2);
            glm::dvec3 variance, relative;
            const auto count = double(surface.count);
            for (int c = 0; c < 3; ++c) {
                const PreciseSum &sensor = sums[Surface::kSensor + c];
                const double mean = surface.count > 0 ? sensor.Value() / count : 0;
                variance[c] = VarianceOf(sensor, sums[Surface::kSquares + c], count);
                relative[c] = mean != 0 ? variance[c] / mean : 0;
            }
            put3(variance);
            put3(relative);
        });
        return image;
    }

  private:
    // clang-format off
    static constexpr std::array<const char *, 22> kFurtherChannels = {
        "Albedo.R", "Albedo.G", "Albedo.B", "P.X", "P.Y", "P.Z", "dzdx", "dzdy", "N.X", "N.Y", "N.Z", "Ns.X", "Ns.Y",
        "Ns.Z", "u", "v", "Variance.R", "Variance.G", "Variance.B", "RelativeVariance.R", "RelativeVariance.G",
        "RelativeVariance.B"};
    // clang-format on
    std::vector<StateBlock> Blocks() const override {
        std::vector<StateBlock> blocks = RgbFilm::Blocks();
        blocks.insert(blocks.begin(), MakeStateBlock("surfaces", std::span(surfaces_)));
        return blocks;
    }
    struct Surface {
        /// Indices in `sums`. kSensor and kSquares: of samples with a surface hit, unweighted.
        static constexpr size_t kP = 0, kN = 3, kNs = 6, kAlbedo = 9, kUv = 12, kDz = 14, kSensor = 18, kSquares = 21,
                                kEnd = 24;
        static constexpr size_t kWeight = 16;     ///< of samples with a surface hit
        static constexpr size_t kRayWeight = 17;  ///< of samples with a camera ray
        std::array<PreciseSum, kEnd> sums;
        uint64_t count = 0;  ///< samples with a surface hit

        /// Adds a vector.
        void Add(size_t first, double weight, const auto &v) {
            for (int c = 0; c < v.length(); ++c) sums[first + c].Add(weight * double(v[c]));
        }
        void operator+=(const Surface &other) {
            for (size_t i = 0; i < kEnd; ++i) sums[i] += other.sums[i];
            count += other.count;
        }
    };
    AnimatedTransform renderFromOutput_;  ///< output: camera or world space
    std::vector<Surface> surfaces_;
};

}  // namespace pbrt
