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

GBufferFilm::GBufferFilm(const ParamSet &params, const ColorSpace &outputSpace, Float exposureTime,
                         const FilmOverrides &overrides, DiagnosticSink &sink)
    : RgbFilm(FilmKind::GBuffer, params, outputSpace, exposureTime, overrides, sink,
              static_cast<double>(sizeof(Pixel) + kFurtherChannels.size() * sizeof(float))),
      coordinates_(params.GetChoice("coordinatesystem", "camera", {"camera", "world"}) == "camera"
                       ? CoordinateSystem::Camera
                       : CoordinateSystem::World),
      pixels_(PixelCount()) {}

void GBufferFilm::AddSample(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight,
                            const std::optional<VisibleSurface> &visible) {
    PBRT_DCHECK(PixelBounds().Contains(pixel));
    Vector3 sensor;
    if (!Measure(L, lambda, weight, &sensor)) return;
    const size_t index = IndexOf(pixel);
    AddToSums(index, sensor, weight);
    if (!visible) return;
    Pixel &sums = pixels_[index];
    for (int c = 0; c < 3; ++c)
        sums.moments[c].Add(double(sensor[c]));
    const double w = double(weight);
    sums.weight += w;
    sums.p += w * glm::dvec3(visible->p);
    sums.n += w * glm::dvec3(visible->n);
    sums.ns += w * glm::dvec3(visible->ns);
    sums.uv += w * glm::dvec2(visible->uv);
    sums.dz += w * glm::dvec2(double(visible->dzdx), double(visible->dzdy));
    // The colour that a white light of the output space has after one reflection.
    const SampledSpectrum reflected =
        SafeDivide(visible->albedo * OutputSpace().Illuminant().Sample(visible->lambda), visible->lambda.Pdf());
    const Xyz xyz((reflected * CieX().Sample(visible->lambda)).Average(),
                  (reflected * CieY().Sample(visible->lambda)).Average(),
                  (reflected * CieZ().Sample(visible->lambda)).Average());
    sums.albedo += w * glm::dvec3(OutputSpace().ToRgb(xyz / CieYIntegral));
}

Image GBufferFilm::ToImage() const {
    Image image = MakeImage({kFurtherChannels.begin(), kFurtherChannels.end()});
    const Pixel *pixel = pixels_.data();
    size_t index = 0;
    for (int y = 0; y < image.Resolution().y; ++y)
        for (int x = 0; x < image.Resolution().x; ++x, ++pixel, ++index) {
            int channel = 3;
            auto put = [&](double v) { image.Set({x, y}, channel++, static_cast<Float>(v)); };
            auto put3 = [&](const glm::dvec3 &v) {
                for (int c = 0; c < 3; ++c) put(v[c]);
            };
            auto unit = [](const glm::dvec3 &v) { return glm::dot(v, v) > 0 ? glm::normalize(v) : glm::dvec3(0); };
            const double seen = pixel->weight != 0 ? 1 / pixel->weight : 0;
            const double weight = WeightOf(index);
            // Albedo counts samples that see nothing as black; the geometry leaves them out.
            put3(weight != 0 ? pixel->albedo / weight : glm::dvec3(0));
            put3(pixel->p * seen);
            put(pixel->dz.x * seen);
            put(pixel->dz.y * seen);
            put3(unit(pixel->n));
            put3(unit(pixel->ns));
            put(pixel->uv.x * seen);
            put(pixel->uv.y * seen);
            for (const RunningMoments &m : pixel->moments) put(m.Variance());
            for (const RunningMoments &m : pixel->moments) put(m.Mean() != 0 ? m.Variance() / m.Mean() : 0);
        }
    return image;
}

}  // namespace pbrt
