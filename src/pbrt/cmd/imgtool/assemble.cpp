#include "pbrt/cmd/imgtool/commands.h"
#include "pbrt/core/log.h"

namespace pbrt::imgtool {

namespace {

struct AssembleOptions {
    std::vector<std::string> paths;
    std::string outfile;
};

int Assemble(const AssembleOptions &o) {
    ImageFile whole;
    std::vector<uint8_t> counts;
    for (const std::string &path : o.paths) {
        const ImageFile part = ReadImage(path);
        const ImageMetadata &m = part.metadata;
        if (!m.pixelBounds || !m.fullResolution)
            throw UserError(fmt::format("{}: has no data window; only .exr files have one.", path));
        const Point2i resolution = *m.fullResolution;
        if (path == o.paths[0]) {
            whole.metadata = m;
            whole.metadata.pixelBounds = Bounds2i{{0, 0}, resolution};
            whole.image = Image(part.image.Format(), resolution, part.image.Channels());
            counts.assign(static_cast<size_t>(resolution.x) * resolution.y, 0);
        }
        if (resolution != whole.image.Resolution())
            throw UserError(
                fmt::format("Parts of different pictures: {} belongs to a picture of {}, {} to one of {} x {}.",
                            o.paths[0], SizeText(whole.image), path, resolution.x, resolution.y));
        if (part.image.Channels() != whole.image.Channels() || &SpaceOf(part) != &SpaceOf(whole))
            throw UserError(fmt::format("{} and {} have different channels or colour spaces.", o.paths[0], path));
        const Bounds2i &window = *m.pixelBounds;
        if (window.low.x < 0 || window.low.y < 0 || window.high.x > resolution.x || window.high.y > resolution.y)
            throw UserError(fmt::format("{}: its pixels (x {} to {}, y {} to {}) reach beyond the picture of {} x {}.",
                                        path, window.low.x, window.high.x, window.low.y, window.high.y, resolution.x,
                                        resolution.y));
        ForEachPixel(part.image, [&](Point2i p) {
            const Point2i at = p + window.low;
            for (int c = 0; c < part.image.ChannelCount(); ++c) whole.image.Set(at, c, part.image.Get(p, c));
            uint8_t &count = counts[static_cast<size_t>(at.y) * resolution.x + at.x];
            count = static_cast<uint8_t>(std::min(count + 1, 2));
        });
    }
    const auto missing = std::count(counts.begin(), counts.end(), 0);
    const auto twice = std::count(counts.begin(), counts.end(), 2);
    if (twice) LogWarning(fmt::format("{} in more than one file; the last file counts.", CountText(twice, "pixel")));
    if (missing) LogWarning(fmt::format("{} of {} pixels are in no file and stay 0.", missing, counts.size()));
    WriteImage(o.outfile, whole.image, whole.metadata);
    return 0;
}

}  // namespace

void AddAssemble(CLI::App &app, Action &action) {
    auto [command, o] = AddCommand(app, action, Assemble, "assemble", "Join parts of one picture",
                                   "Example: imgtool assemble left.exr right.exr --outfile whole.exr");
    AddFlags(command,
             {Flag("files", o.paths, "Parts: .exr files with data windows").Required(), OutfileFlag(o.outfile)});
}

}  // namespace pbrt::imgtool
