#pragma once
#include <array>

#include "pbrt/cmd/flags.h"
#include "pbrt/images/image.h"
#include "pbrt/images/metrics.h"

namespace pbrt::imgtool {

/// Runs a command and returns the exit status. Throws UserError.
using Action = std::function<int()>;

/// Adds a subcommand to `app`; sets `action`, which must outlive parsing, if it is selected.
using CommandAdder = void(CLI::App &app, Action &action);
CommandAdder AddInfo, AddConvert, AddDiff, AddError, AddFalsecolor, AddAverage, AddAssemble, AddMerge, AddSplitn,
    AddBloom, AddWhitebalance, AddScalenormalmap, AddMakeequiarea, AddMakesky;

/// Adds a subcommand with action `run`. Returns it and the options to be declared.
template <class O>
std::pair<CLI::App &, O &> AddCommand(CLI::App &app, Action &action, int (*run)(const O &), const std::string &name,
                                      const std::string &about, const std::string &footer) {
    auto options = std::make_shared<O>();
    CLI::App *command = app.add_subcommand(name, about);
    command->footer(footer);
    command->callback([=, &action] { action = [=] { return run(*options); }; });
    return {*command, *options};
}

/// Splits "R,G,B" into names; wavelength channels may contain a comma. Throws UserError for empty names.
inline std::vector<std::string> SplitChannels(const std::string &list) {
    std::vector<std::string> names;
    auto digit = [](char c) { return c >= '0' && c <= '9'; };
    for (const std::string &part : CLI::detail::split(list, ',')) {
        if (part.empty()) throw UserError("--channels {}: a channel name is empty.", list);
        // A comma between digits belongs to a wavelength of the spectral film.
        if (!names.empty() && digit(names.back().back()) && digit(part[0])) names.back() += ',' + part;
        else names.push_back(part);
    }
    return names;
}
/// Indices of the channels R, G, B. Throws UserError if one is missing.
inline std::array<int, 3> RgbChannels(const Image &image, const std::string &path) {
    std::array<int, 3> channels{};
    for (size_t c = 0; c < 3; ++c) {
        const std::string name(1, "RGB"[c]);
        channels[c] = image.FindChannel(name);
        if (channels[c] < 0)
            throw UserError("{}: has no channel {}; its channels are {}.", path, name,
                            fmt::join(image.Channels(), ", "));
    }
    return channels;
}
inline Rgb GetRgb(const Image &image, Point2i p, const std::array<int, 3> &channels) {
    return {image.Get(p, channels[0]), image.Get(p, channels[1]), image.Get(p, channels[2])};
}
inline void SetRgb(Image &image, Point2i p, const std::array<int, 3> &channels, const Rgb &rgb) {
    for (int c = 0; c < 3; ++c) image.Set(p, channels[c], rgb[c]);
}

/// Colour channels: all but alpha.
inline std::vector<int> ColorChannels(const Image &image) {
    std::vector<int> indices;
    for (int c = 0; c < image.ChannelCount(); ++c)
        if (image.Channels()[c] != "A") indices.push_back(c);
    return indices;
}
/// Their mean, as channel Y.
inline Image AverageChannels(const Image &image) {
    Image result(PixelFormat::Float, image.Resolution(), {"Y"});
    const std::vector<int> colors = ColorChannels(image);
    ForEachPixel(image, [&](Point2i p) {
        Float sum = 0;
        for (int c : colors) sum += image.Get(p, c);
        result.Set(p, 0, colors.empty() ? 0 : sum / Float(colors.size()));
    });
    return result;
}

inline std::string SizeText(const Image &image) {
    return fmt::format("{} x {}", image.Resolution().x, image.Resolution().y);
}
/// Colour space of the file; default sRGB.
inline const ColorSpace &SpaceOf(const ImageFile &file) {
    return file.metadata.colorSpace ? *file.metadata.colorSpace : ColorSpace::SRGB();
}

/// Data window of the file; default all pixels.
inline Bounds2i WindowOf(const ImageFile &file) {
    return file.metadata.pixelBounds.value_or(Bounds2i{{0, 0}, file.image.Resolution()});
}
/// "x 0 to 8, y 0 to 4".
inline std::string WindowText(const ImageFile &file) {
    const Bounds2i w = WindowOf(file);
    return fmt::format("x {} to {}, y {} to {}", w.low.x, w.high.x, w.low.y, w.high.y);
}
/// Crops to x0,x1,y0,y1 (half-open, in pixels of the whole image; none: everything) and sets both windows. Throws
/// UserError if they exceed the data window.
inline void ApplyCrop(ImageFile &file, const std::vector<int> &n, const std::string &path) {
    if (n.empty()) return;
    PBRT_CHECK(n.size() == 4);
    const Bounds2i window = WindowOf(file), bounds{{n[0], n[2]}, {n[1], n[3]}};
    if (bounds.IsEmpty())
        throw UserError("--crop {},{},{},{}: nothing is left; the order is x0,x1,y0,y1.", n[0], n[1], n[2], n[3]);
    if (bounds.low.x < window.low.x || bounds.low.y < window.low.y || bounds.high.x > window.high.x ||
        bounds.high.y > window.high.y)
        throw UserError("--crop {},{},{},{}: {} has only {} x {} pixels: {} (ends excluded).", n[0], n[1], n[2], n[3],
                        path, window.Width(), window.Height(), WindowText(file));
    file.image = file.image.Crop({bounds.low - window.low, bounds.high - window.low});
    file.metadata.pixelBounds = bounds;
    if (!file.metadata.fullResolution) file.metadata.fullResolution = window.high;
}

inline Flag CropFlag(std::vector<int> &numbers) {
    return Flag("--crop", numbers,
                "Only these pixels: columns x0 up to x1, rows y0 up to y1 (ends excluded), counted in the whole "
                "image also if the file has a part of it")
        .Count(4)
        .Type("x0,x1,y0,y1");
}
/// The required flag --outfile. If `isPositional`, the bare name may follow the image.
inline Flag OutfileFlag(std::string &path, bool isPositional = false) {
    return Flag(isPositional ? "outfile,--outfile" : "--outfile", path, "Result: .exr, .png, .pfm or .jpg")
        .Required()
        .Type("FILE");
}

/// Metric by name. Throws UserError with the choices.
inline Metric ChosenMetric(const std::string &name) {
    if (auto metric = ParseMetric(name)) return *metric;
    throw UserError("--metric {}: unknown; {}", name, ListChoices(name, MetricNames()));
}
/// Throws UserError unless resolution, data window, colour space and channels match; `hint`: for channels.
inline void CheckComparable(const ImageFile &a, const std::string &pathA, const ImageFile &b, const std::string &pathB,
                            const std::string &hint = "") {
    if (a.image.Resolution() != b.image.Resolution())
        throw UserError("Different resolutions: {} has {}, {} has {}.", pathA, SizeText(a.image), pathB,
                        SizeText(b.image));
    // Formats other than EXR store no window.
    if (a.metadata.pixelBounds && b.metadata.pixelBounds && WindowOf(a).low != WindowOf(b).low)
        throw UserError("Different parts of an image: {} has {}, {} has {} (ends excluded).", pathA, WindowText(a),
                        pathB, WindowText(b));
    if (&SpaceOf(a) != &SpaceOf(b))
        throw UserError("Different colour spaces: {} has {}, {} has {}.", pathA, SpaceOf(a).Name(), pathB,
                        SpaceOf(b).Name());
    if (a.image.Channels() != b.image.Channels())
        throw UserError("Different channels: {} has {}, {} has {}{}.", pathA, fmt::join(a.image.Channels(), ","), pathB,
                        fmt::join(b.image.Channels(), ","), hint);
}

inline ImageFile ReadAsFloat(const std::string &path) {
    ImageFile file = ReadImage(path);
    file.image = file.image.ConvertTo(PixelFormat::Float);
    return file;
}
/// Files that match `names`, without duplicates. A name is a file, a pattern with * and ? in the last path component,
/// or a prefix of image paths. Pattern and prefix matches are sorted. Files in `except` are left out, so that earlier
/// results are no input. Throws UserError for a name without match, or if no file is left.
std::vector<std::string> FindImages(const std::vector<std::string> &names, const std::vector<std::string> &except);
inline constexpr const char *kImagesHelp =
    "Images: names of files, patterns in quotes such as 'runs/seed*.exr', or starts of names such as runs/seed";

}  // namespace pbrt::imgtool
