#include "pbrt/films/rgb_film.h"

namespace pbrt {

RgbFilm::RgbFilm(const FilmParams &params, const ParamSet &set, const FilmRequest &request)
    : Film("rgb", request.Frame(params, set, {.onlyExr = false, .bytesPerPixel = SensorSums::kBytesPerPixel})),
      sums_(params, set, Frame(), request.context.exposureTime) {}

RgbFilm::RgbFilm(const FilmFrame &frame, const SensorSums &like)
    : Film("rgb", frame.WithFullFloat()), sums_(like.MakeEmpty(Frame())) {}

void RgbFilm::AddSample(const FilmSample &sample) {
    if (std::optional<Vector3> sensor = sums_.Measure(sample.L, sample.lambda, sample.weight))
        sums_.Add(Frame().IndexOf(sample.pixel), *sensor, sample.weight);
}

void RgbFilm::AddSplat(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) {
    if (PixelBounds().Contains(pixel)) sums_.AddSplat(Frame().IndexOf(pixel), L, lambda, weight);
}

std::vector<StateBlock> RgbFilm::Blocks() const {
    std::vector<StateBlock> blocks;
    sums_.AppendBlocks(blocks);
    return blocks;
}

}  // namespace pbrt
