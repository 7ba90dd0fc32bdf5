#include "pbrt/lights/light_image.h"

#include "pbrt/core/parallel.h"

namespace pbrt {

LightImage ReadLightImage(const ParamSet &params, const std::string &parameter, const FileResolver &files) {
    LightImage result;
    FileLoc loc = params.LocOf(parameter);
    result.name = files.Resolve(params.GetString(parameter, ""));
    try {
        ImageFile file = ReadImage(result.name);
        for (const char *channel : {"R", "G", "B"})
            if (file.image.FindChannel(channel) < 0)
                throw UserError(
                    fmt::format("\"{}\": an image that emits light must have channels R, G and B.", result.name));
        result.image = file.image.Select({"R", "G", "B"});
        result.colorSpace = file.metadata.colorSpace ? file.metadata.colorSpace : &ColorSpace::SRGB();
    } catch (const UserError &e) {
        std::vector<Diagnostic> located = e.Diagnostics();
        for (Diagnostic &d : located)
            if (!d.loc) d.loc = loc;
        throw UserError(std::move(located));
    }
    Point2i n = result.image.Resolution();
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x)
            for (int c = 0; c < 3; ++c)
                if (!std::isfinite(result.image.Get({x, y}, c)))
                    throw UserError(
                        fmt::format("\"{}\": pixel ({}, {}) is infinite or not a number; such an image cannot "
                                    "emit light.",
                                    result.name, x, y),
                        loc);
    return result;
}

SampledSpectrum AverageIlluminant(const Image &image, const ColorSpace &colorSpace, const SampledWavelengths &lambda) {
    Point2i n = image.Resolution();
    std::vector<SampledSpectrum> rows(static_cast<size_t>(n.y));
    ParallelFor(n.y, 8, [&](int64_t begin, int64_t end) {
        for (int64_t y = begin; y < end; ++y) {
            SampledSpectrum sum;
            for (int x = 0; x < n.x; ++x)
                sum += RgbIlluminantSpectrum(colorSpace, LightPixel(image, {x, static_cast<int>(y)})).Sample(lambda);
            rows[static_cast<size_t>(y)] = sum / static_cast<Float>(n.x);
        }
    });
    SampledSpectrum sum;
    for (const SampledSpectrum &row : rows) sum += row;
    return sum / static_cast<Float>(n.y);
}

}  // namespace pbrt
