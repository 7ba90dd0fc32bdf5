#include <fmt/ranges.h>

#include <algorithm>
#include <tuple>

#include "pbrt/cmd/imgtool/commands.h"
#include "pbrt/core/log.h"
#include "pbrt/films/render_file.h"

namespace pbrt::imgtool {
namespace {

/// Of all three commands.
struct CombineOptions {
    std::vector<std::string> paths;
    std::string outfile;
    bool incomplete = false;
};

int Average(const CombineOptions &o) {
    const std::vector<std::string> paths = FindImages(o.paths, {o.outfile});
    ImageFile first = ReadAsFloat(paths[0]);
    std::vector<double> sums(first.image.ValueCount(), 0);
    for (const std::string &path : paths) {
        const ImageFile file = path == paths[0] ? first : ReadAsFloat(path);
        CheckComparable(first, paths[0], file, path);
        const float *values = static_cast<const float *>(file.image.Data());
        for (size_t i = 0; i < sums.size(); ++i) sums[i] += double(values[i]);
    }
    float *values = static_cast<float *>(first.image.Data());
    for (size_t i = 0; i < sums.size(); ++i) values[i] = float(sums[i] / double(paths.size()));
    WriteImage(o.outfile, first.image, first.metadata);
    fmt::print("{}: mean of {}: {}\n", o.outfile, CountText(paths.size(), "image"), fmt::join(paths, ", "));
    return 0;
}

int Assemble(const CombineOptions &o) {
    ImageFile whole;
    std::vector<uint8_t> counts;
    for (const std::string &path : o.paths) {
        const ImageFile part = ReadImage(path);
        const ImageMetadata &m = part.metadata;
        if (!m.pixelBounds || !m.fullResolution)
            throw UserError("{}: has no data window; only .exr files have one.", path);
        const Point2i resolution = *m.fullResolution;
        if (path == o.paths[0]) {
            whole.metadata = m;
            whole.metadata.pixelBounds = Bounds2i{{0, 0}, resolution};
            whole.image = Image(part.image.Format(), resolution, part.image.Channels());
            counts.assign(size_t(resolution.x) * resolution.y, 0);
        }
        if (resolution != whole.image.Resolution())
            throw UserError("Parts of different images: {} belongs to an image of {}, {} to one of {} x {}.",
                            o.paths[0], SizeText(whole.image), path, resolution.x, resolution.y);
        if (part.image.Channels() != whole.image.Channels() || &SpaceOf(part) != &SpaceOf(whole))
            throw UserError("{} and {} have different channels or colour spaces.", o.paths[0], path);
        const Bounds2i &window = *m.pixelBounds;
        if (window.low.x < 0 || window.low.y < 0 || window.high.x > resolution.x || window.high.y > resolution.y)
            throw UserError("{}: its pixels ({}) reach beyond the image of {} x {}.", path, WindowText(part),
                            resolution.x, resolution.y);
        ForEachPixel(part.image, [&](Point2i p) {
            const Point2i at = p + window.low;
            for (int c = 0; c < part.image.ChannelCount(); ++c) whole.image.Set(at, c, part.image.Get(p, c));
            uint8_t &count = counts[size_t(at.y) * resolution.x + at.x];
            count = uint8_t(std::min(count + 1, 2));
        });
    }
    const auto missing = std::count(counts.begin(), counts.end(), 0);
    const auto twice = std::count(counts.begin(), counts.end(), 2);
    if (twice) LogWarning("{} in more than one file; the last file counts.", CountText(twice, "pixel"));
    if (missing) LogWarning("{} of {} pixels are in no file and stay 0.", missing, counts.size());
    WriteImage(o.outfile, whole.image, whole.metadata);
    return 0;
}

constexpr const char *kIncomplete = ", and --incomplete makes the image of the samples that there are";

struct PartialRender {
    std::string path;
    RenderFileHead head;
    std::string Range() const { return fmt::format("{}:{}", head.first, head.done); }
};

/// The part without its sums, which are not in memory for all parts at once.
PartialRender ReadPartialRender(const std::string &path, bool incomplete) {
    PartialRender part{path, RenderFile(path).Head()};
    RenderFileHead &head = part.head;
    const bool isEndOpen = head.end == 0;  // of a render with --time or --noise
    if (isEndOpen && !head.metadata.attributes.contains("pbrt.interrupted")) head.end = head.done;
    if (head.passCount > 0 || (!incomplete && (head.end == 0 || head.done != head.end)))
        throw UserError("{}: is unfinished: {} it has {}; the same command with --resume completes it{}.", path,
                        isEndOpen ? "of a render with --time or --noise"
                                  : fmt::format("of the samples {}:{}", head.first, head.end),
                        part.Range() + (head.passCount > 0 ? " and some more of some pixels" : ""),
                        head.passCount > 0 ? "" : kIncomplete);
    return part;
}

void CheckSameRender(const PartialRender &one, const PartialRender &other) {
    const RenderFileHead &a = other.head, &b = one.head;
    std::string differences = DifferencesOf(a.identity, b.identity, one.path);
    if (std::tie(a.samplesFlag, a.samplesPerBatch) != std::tie(b.samplesFlag, b.samplesPerBatch))
        differences += fmt::format("{}the render has {} per pixel, but {} in {}", differences.empty() ? "" : "; ",
                                   CountText(a.samplesPerBatch, "sample"), b.samplesPerBatch, one.path);
    if (!differences.empty())
        throw UserError("{} and {} are not parts of one render: {}.", other.path, one.path, differences);
}

/// `parts` are sorted. Returns their total number of samples.
int CheckCover(const std::vector<PartialRender> &parts, bool incomplete) {
    std::string problems;
    int next = 0, total = 0, all = 0;
    const PartialRender *before = nullptr;
    bool isMissing = false;
    const auto missing = [&](int first, int end) {
        if (incomplete) LogWarning("the samples {}:{} are missing.", first, end);
        else problems += fmt::format("The samples {}:{} are in no file. ", first, end);
        isMissing = true;
    };
    for (const PartialRender &part : parts) {
        const RenderFileHead &head = part.head;
        if (head.first > next) missing(next, head.first);
        if (before && head.first < next)
            problems += fmt::format("{} ({}) and {} ({}) have samples in common. ", before->path, before->Range(),
                                    part.path, part.Range());
        total += head.done - head.first;
        all = std::max(all, head.isPart || head.end == 0 ? head.samplesPerBatch : head.end);
        if (head.done > next || !before) before = &part;
        next = std::max(next, head.done);
    }
    if (total == 0) throw UserError("{}: has no samples yet.", parts[0].path);
    if (next < all) missing(next, all);
    if (!problems.empty()) {
        problems.pop_back();
        if (isMissing) problems.insert(problems.size() - 1, kIncomplete);
        throw UserError(problems);
    }
    return total;
}

int Merge(const CombineOptions &o) {
    CheckImageName(o.outfile, {});
    std::vector<PartialRender> parts;
    for (const std::string &path : o.paths) {
        parts.push_back(ReadPartialRender(path, o.incomplete));
        CheckSameRender(parts[0], parts.back());
    }
    std::stable_sort(parts.begin(), parts.end(),
                     [](const PartialRender &a, const PartialRender &b) { return a.head.first < b.head.first; });
    const int samples = CheckCover(parts, o.incomplete);
    const std::unique_ptr<Film> film = parts[0].head.film.Make();
    double seconds = 0;
    for (const PartialRender &part : parts) {
        RenderFile(part.path).MergeFilm(*film);
        seconds += part.head.renderSeconds;
    }
    ImageMetadata metadata = film->Metadata();
    metadata.attributes = parts[0].head.metadata.attributes;
    metadata.attributes["samplesPerPixel"] = samples;
    metadata.attributes["renderTimeSeconds"] = float(seconds);
    metadata.attributes["pbrt.parts"] = int(parts.size());
    WriteImage(o.outfile, film->ToImage(), metadata);
    fmt::print("{}: {} per pixel from {}\n", o.outfile, CountText(samples, "sample"), CountText(parts.size(), "file"));
    return 0;
}

}  // namespace

void AddAverage(CLI::App &app, Action &action) {
    auto [command, o] = AddCommand(app, action, Average, "average", "Mean of several images",
                                   "Example: imgtool average runs/seed --outfile mean.exr");
    AddFlags(command, {Flag("images", o.paths, kImagesHelp).Required(),
                       Flag("--outfile", o.outfile,
                            "Result; not averaged itself, even if a pattern or the start of a name fits it")
                           .Required()
                           .Type("FILE")});
}

void AddAssemble(CLI::App &app, Action &action) {
    auto [command, o] = AddCommand(app, action, Assemble, "assemble", "Join parts of one image",
                                   "Example: imgtool assemble left.exr right.exr --outfile whole.exr");
    AddFlags(command,
             {Flag("files", o.paths, "Parts: .exr files with data windows").Required(), OutfileFlag(o.outfile)});
}

void AddMerge(CLI::App &app, Action &action) {
    auto [command, o] = AddCommand(app, action, Merge, "merge", "Make the image from the parts of a render",
                                   "Example: imgtool merge image.exr part-*.chk");
    AddFlags(
        command,
        {Flag("outfile", o.outfile, "Result: .exr, .png or .pfm").Required().Type("FILE"),
         Flag("parts", o.paths,
              "Files that pbrt --samples FIRST:END --checkpoint FILE wrote, in any order; together they must "
              "have every sample once")
             .Required()
             .Type("PART..."),
         {"--incomplete", o.incomplete, "Make the image of the samples that there are, although some are missing"}});
}

}  // namespace pbrt::imgtool
