#include "pbrt/lights/light_image.h"

#include "pbrt/core/parallel.h"

namespace pbrt {

namespace {

bool HasRgb(const Image &image) {
    return image.FindChannel("R") >= 0 && image.FindChannel("G") >= 0 && image.FindChannel("B") >= 0;
}

/// `select` picks the channels; its complaints need no place.
template <class Select>
LightImage Read(const ParamSet &params, const std::string &parameter, const FileResolver &files, Select select) {
    LightImage result;
    FileLoc loc = params.LocOf(parameter);
    result.name = files.Resolve(params.GetString(parameter, ""));
    try {
        ImageFile file = ReadImage(result.name);
        result.image = select(file.image, result.name);
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
            for (int c = 0; c < result.image.ChannelCount(); ++c)
                if (!std::isfinite(result.image.Get({x, y}, c)))
                    throw UserError(
                        fmt::format("\"{}\": pixel ({}, {}) is infinite or not a number; such an image cannot "
                                    "emit light.",
                                    result.name, x, y),
                        loc);
    return result;
}

}  // namespace

LightImage ReadLightImage(const ParamSet &params, const std::string &parameter, const FileResolver &files) {
    return Read(params, parameter, files, [](const Image &image, const std::string &name) {
        if (!HasRgb(image))
            throw UserError(fmt::format("\"{}\": an image that emits light must have channels R, G and B.", name));
        return image.Select({"R", "G", "B"});
    });
}

LightImage ReadIntensityImage(const ParamSet &params, const std::string &parameter, const FileResolver &files) {
    return Read(params, parameter, files, [](const Image &image, const std::string &name) {
        bool hasY = image.FindChannel("Y") >= 0;
        if (HasRgb(image) == hasY)
            throw UserError(fmt::format(
                "\"{}\": an image of intensities must have either a channel Y or channels R, G and B.", name));
        if (hasY) return image.Select({"Y"});
        Image rgb = image.Select({"R", "G", "B"}), mean(PixelFormat::Float, rgb.Resolution(), {"Y"});
        for (int y = 0; y < rgb.Resolution().y; ++y)
            for (int x = 0; x < rgb.Resolution().x; ++x)
                mean.Set({x, y}, 0, (rgb.Get({x, y}, 0) + rgb.Get({x, y}, 1) + rgb.Get({x, y}, 2)) / 3);
        return mean;
    });
}

SampledSpectrum AverageIlluminant(const Image &image, const ColorSpace &colorSpace, const SampledWavelengths &lambda,
                                  const std::function<Float(int, int)> &weight) {
    Point2i n = image.Resolution();
    std::vector<SampledSpectrum> rows(static_cast<size_t>(n.y));
    ParallelFor(n.y, 8, [&](int64_t begin, int64_t end) {
        for (int64_t y = begin; y < end; ++y) {
            SampledSpectrum sum;
            for (int x = 0; x < n.x; ++x) {
                SampledSpectrum L = PixelIlluminant(image, {x, static_cast<int>(y)}, colorSpace, lambda);
                sum += weight ? weight(x, static_cast<int>(y)) * L : L;
            }
            rows[static_cast<size_t>(y)] = sum / static_cast<Float>(n.x);
        }
    });
    SampledSpectrum sum;
    for (const SampledSpectrum &row : rows) sum += row;
    return sum / static_cast<Float>(n.y);
}

}  // namespace pbrt
