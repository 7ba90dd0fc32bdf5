#include "pbrt/films/gbuffer_film.h"

#include <array>

namespace pbrt {

namespace {

// clang-format off
constexpr std::array<const char *, 22> kFurtherChannels = {
    "Albedo.R", "Albedo.G", "Albedo.B", "P.X", "P.Y", "P.Z", "dzdx", "dzdy", "N.X", "N.Y", "N.Z", "Ns.X", "Ns.Y",
    "Ns.Z", "u", "v", "Variance.R", "Variance.G", "Variance.B", "RelativeVariance.R", "RelativeVariance.G",
    "RelativeVariance.B"};
// clang-format on

}  // namespace

GBufferFilm::GBufferFilm(const GBufferParams &params, const ParamSet &set, const FilmRequest &request)
    : RgbFilm("gbuffer", params, set, request, kFurtherChannels.size() * sizeof(float) + sizeof(Surface)),
      renderFromOutput_(params.space == GBufferParams::Space::Camera
                            ? request.context.renderFromCamera
                            : AnimatedTransform(request.context.renderFromWorld)),
      surfaces_(Frame().PixelCount()) {}

void GBufferFilm::AddSample(const FilmSample &sample) {
    const std::optional<Vector3> sensor = Measure(sample.L, sample.lambda, sample.weight);
    if (!sensor) return;
    const size_t index = Frame().IndexOf(sample.pixel);
    Add(index, *sensor, sample.weight);
    Surface &sums = surfaces_[index];
    const double w = double(sample.weight);
    if (sample.hasRay) sums.rayWeight.Add(w);
    if (!sample.visible) return;
    const VisibleSurface &visible = *sample.visible;
    const Transform outputFromRender = renderFromOutput_.At(visible.time).Inverse();
    auto output = [&](const Normal3 &n) { return glm::dvec3(Normalize(outputFromRender.Normal(n))); };
    auto depth = [&](const Vector3 &v) { return double(std::abs(outputFromRender.Vector(v).z)); };
    const glm::dvec3 measured(*sensor);
    sums.sensor.Add(1, measured);
    sums.squares.Add(1, measured * measured);
    ++sums.count;
    sums.weight.Add(w);
    sums.p.Add(w, glm::dvec3(outputFromRender.Point(visible.p)));
    sums.n.Add(w, output(visible.n));
    sums.ns.Add(w, output(visible.ns));
    sums.uv.Add(w, glm::dvec2(visible.uv));
    sums.dz.Add(w, glm::dvec2(depth(visible.dpdx), depth(visible.dpdy)));
    sums.albedo.Add(w, glm::dvec3(AlbedoColor(visible, OutputSpace())));
}

void GBufferFilm::Surface::operator+=(const Surface &other) {
    p += other.p;
    n += other.n;
    ns += other.ns;
    albedo += other.albedo;
    uv += other.uv;
    dz += other.dz;
    weight += other.weight;
    rayWeight += other.rayWeight;
    sensor += other.sensor;
    squares += other.squares;
    count += other.count;
}

std::vector<StateBlock> GBufferFilm::Blocks() const {
    std::vector<StateBlock> blocks = RgbFilm::Blocks();
    blocks.insert(blocks.begin(), MakeStateBlock("surfaces", std::span(surfaces_)));
    return blocks;
}

Image GBufferFilm::ToImage() const {
    Image image = MakeImage({kFurtherChannels.begin(), kFurtherChannels.end()});
    const Surface *pixel = surfaces_.data();
    for (int y = 0; y < image.Resolution().y; ++y)
        for (int x = 0; x < image.Resolution().x; ++x, ++pixel) {
            int channel = 3;
            auto put = [&](double v) { image.Set({x, y}, channel++, static_cast<Float>(v)); };
            auto put3 = [&](const glm::dvec3 &v) {
                for (int c = 0; c < 3; ++c) put(v[c]);
            };
            auto unit = [](const glm::dvec3 &v) { return glm::dot(v, v) > 0 ? glm::normalize(v) : glm::dvec3(0); };
            const double seenWeight = pixel->weight.Value(), seen = seenWeight != 0 ? 1 / seenWeight : 0;
            const double weight = pixel->rayWeight.Value();
            // Albedo counts rays without a hit as black; geometry excludes them.
            put3(weight != 0 ? pixel->albedo.Value() / weight : glm::dvec3(0));
            put3(pixel->p.Value() * seen);
            put(pixel->dz.of[0].Value() * seen);
            put(pixel->dz.of[1].Value() * seen);
            put3(unit(pixel->n.Value()));
            put3(unit(pixel->ns.Value()));
            put(pixel->uv.of[0].Value() * seen);
            put(pixel->uv.of[1].Value() * seen);
            glm::dvec3 variance, relative;
            const auto count = static_cast<double>(pixel->count);
            for (int c = 0; c < 3; ++c) {
                const double mean = pixel->count > 0 ? pixel->sensor.of[c].Value() / count : 0;
                variance[c] = VarianceOf(pixel->sensor.of[c], pixel->squares.of[c], count);
                relative[c] = mean != 0 ? variance[c] / mean : 0;
            }
            put3(variance);
            put3(relative);
        }
    return image;
}

}  // namespace pbrt
