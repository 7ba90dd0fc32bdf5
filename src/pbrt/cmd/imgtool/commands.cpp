#include "pbrt/cmd/imgtool/commands.h"

#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <filesystem>

#include "pbrt/core/files.h"

namespace pbrt::imgtool {

std::vector<std::string> SplitChannels(const std::string &list) {
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

std::array<int, 3> RgbChannels(const Image &image, const std::string &path) {
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

std::vector<int> ColorChannels(const Image &image) {
    std::vector<int> indices;
    for (int c = 0; c < image.ChannelCount(); ++c)
        if (image.Channels()[c] != "A") indices.push_back(c);
    return indices;
}

Image AverageChannels(const Image &image) {
    Image result(PixelFormat::Float, image.Resolution(), {"Y"});
    const std::vector<int> colors = ColorChannels(image);
    ForEachPixel(image, [&](Point2i p) {
        Float sum = 0;
        for (int c : colors) sum += image.Get(p, c);
        result.Set(p, 0, colors.empty() ? 0 : sum / Float(colors.size()));
    });
    return result;
}

std::string SizeText(const Image &image) { return fmt::format("{} x {}", image.Resolution().x, image.Resolution().y); }

const ColorSpace &SpaceOf(const ImageFile &file) {
    return file.metadata.colorSpace ? *file.metadata.colorSpace : ColorSpace::SRGB();
}

Bounds2i WindowOf(const ImageFile &file) {
    return file.metadata.pixelBounds.value_or(Bounds2i{{0, 0}, file.image.Resolution()});
}

std::string WindowText(const ImageFile &file) {
    const Bounds2i w = WindowOf(file);
    return fmt::format("x {} to {}, y {} to {}", w.low.x, w.high.x, w.low.y, w.high.y);
}

void ApplyCrop(ImageFile &file, const std::vector<int> &n, const std::string &path) {
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
}

Flag CropFlag(std::vector<int> &numbers) {
    return Flag("--crop", numbers,
                "Only these pixels: columns x0 up to x1, rows y0 up to y1 (ends excluded), counted in the whole "
                "image also if the file has a part of it")
        .Count(4)
        .Type("x0,x1,y0,y1");
}

Flag OutfileFlag(std::string &path, bool isPositional) {
    return Flag(isPositional ? "outfile,--outfile" : "--outfile", path, "Result: .exr, .png, .pfm or .jpg")
        .Required()
        .Type("FILE");
}

Metric ChosenMetric(const std::string &name) {
    if (auto metric = ParseMetric(name)) return *metric;
    throw UserError("--metric {}: unknown; {}", name, ListChoices(name, MetricNames()));
}

void CheckComparable(const ImageFile &a, const std::string &pathA, const ImageFile &b, const std::string &pathB,
                     const std::string &hint) {
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

ImageFile ReadAsFloat(const std::string &path) {
    ImageFile file = ReadImage(path);
    file.image = file.image.ConvertTo(PixelFormat::Float);
    return file;
}

std::vector<std::string> FindImages(const std::vector<std::string> &names, const std::vector<std::string> &except) {
    namespace fs = std::filesystem;
    static const std::vector<std::string> kKnown = {".exr", ".png", ".pfm",  ".hdr", ".jpg", ".jpeg", ".tga", ".bmp",
                                                    ".gif", ".tif", ".tiff", ".ppm", ".pgm", ".pnm",  ".psd", ".qoi"};
    std::error_code code;
    std::vector<std::string> files;
    auto add = [&](const std::string &file) {
        if (std::ranges::count(files, file) == 0) files.push_back(file);
    };
    for (const std::string &name : names) {
        if (fs::is_regular_file(name, code)) {
            add(name);
            continue;
        }
        const fs::path path(name);
        const std::string last = path.filename().string();
        const bool isPattern = last.find_first_of("*?") != std::string::npos;
        std::vector<std::string> found;
        for (const fs::directory_entry &entry :
             fs::directory_iterator(path.has_parent_path() ? path.parent_path() : fs::path("."), code)) {
            const std::string here = entry.path().filename().string();
            const bool fits = isPattern
                                  ? fnmatch(last.c_str(), here.c_str(), FNM_PERIOD) == 0
                                  : here.starts_with(last) && std::ranges::count(kKnown, LowerExtension(here)) > 0;
            if (!fits || !entry.is_regular_file(code)) continue;
            if (std::any_of(except.begin(), except.end(),
                            [&](const std::string &e) { return fs::equivalent(entry.path(), e, code); }))
                continue;
            found.push_back(path.has_parent_path() ? entry.path().string() : here);
        }
        if (found.empty())
            throw UserError(isPattern
                                ? fmt::format("No file fits \"{}\".", name)
                                : fmt::format("No file is called \"{}\", and no image's name starts with it.", name));
        std::sort(found.begin(), found.end());
        for (const std::string &file : found) add(file);
    }
    return files;
}

}  // namespace pbrt::imgtool
