#include <algorithm>
#include <tuple>

#include "pbrt/cmd/imgtool/commands.h"
#include "pbrt/core/log.h"
#include "pbrt/films/render_file.h"
#include "pbrt/images/image.h"

namespace pbrt::imgtool {

namespace {

struct MergeOptions {
    std::string outfile;
    std::vector<std::string> paths;
    bool incomplete = false;
};

constexpr const char *kIncomplete = ", and --incomplete makes the picture of the samples that there are";

struct Part {
    std::string path;
    RenderFileHead head;
    std::string Range() const { return fmt::format("{}:{}", head.first, head.done); }
};

/// The part without its sums, which are not in memory for all parts at once.
Part ReadPart(const std::string &path, bool incomplete) {
    Part part{path, RenderFile(path).Head()};
    const RenderFileHead &head = part.head;
    if (head.passCount > 0 || (!head.IsComplete() && !incomplete))
        throw UserError(fmt::format(
            "{}: is unfinished: of the samples {}:{} it has {}; the same command with --resume completes it{}.", path,
            head.first, head.end, part.Range() + (head.passCount > 0 ? " and some more of some pixels" : ""),
            head.passCount > 0 ? "" : kIncomplete));
    return part;
}

void CheckSameRender(const Part &one, const Part &other) {
    const RenderFileHead &a = other.head, &b = one.head;
    std::string differences = DifferencesOf(a.identity, b.identity, one.path);
    if (std::tie(a.samplesFlag, a.samplesPerBatch) != std::tie(b.samplesFlag, b.samplesPerBatch))
        differences += fmt::format("{}the render has {} per pixel, but {} in {}", differences.empty() ? "" : "; ",
                                   CountText(a.samplesPerBatch, "sample"), b.samplesPerBatch, one.path);
    if (!differences.empty())
        throw UserError(fmt::format("{} and {} are not parts of one render: {}.", other.path, one.path, differences));
}

/// `parts` are sorted. Returns their total number of samples.
int CheckCover(const std::vector<Part> &parts, bool incomplete) {
    std::string problems;
    int next = 0, total = 0, all = parts[0].head.samplesPerBatch;
    const Part *before = nullptr;
    bool isMissing = false;
    const auto missing = [&](int first, int end) {
        if (incomplete) LogWarning(fmt::format("the samples {}:{} are missing.", first, end));
        else problems += fmt::format("The samples {}:{} are in no file. ", first, end);
        isMissing = true;
    };
    for (const Part &part : parts) {
        const RenderFileHead &head = part.head;
        if (head.first > next) missing(next, head.first);
        if (before && head.first < next)
            problems += fmt::format("{} ({}) and {} ({}) have samples in common. ", before->path, before->Range(),
                                    part.path, part.Range());
        total += head.done - head.first;
        all = std::max(all, head.end);
        if (head.done > next || !before) before = &part;
        next = std::max(next, head.done);
    }
    if (next < all) missing(next, all);
    if (!problems.empty()) {
        problems.pop_back();
        if (isMissing) problems.insert(problems.size() - 1, kIncomplete);
        throw UserError(problems);
    }
    return total;
}

int Merge(const MergeOptions &o) {
    CheckPictureName(o.outfile, {});
    std::vector<Part> parts;
    for (const std::string &path : o.paths) {
        parts.push_back(ReadPart(path, o.incomplete));
        CheckSameRender(parts[0], parts.back());
    }
    std::stable_sort(parts.begin(), parts.end(),
                     [](const Part &a, const Part &b) { return a.head.first < b.head.first; });
    const int samples = CheckCover(parts, o.incomplete);
    const std::unique_ptr<Film> film = parts[0].head.film.Make();
    double seconds = 0;
    for (const Part &part : parts) {
        RenderFile(part.path).MergeFilm(*film);
        seconds += part.head.renderSeconds;
    }
    ImageMetadata metadata = film->Metadata();
    metadata.attributes = parts[0].head.metadata.attributes;
    metadata.attributes["samplesPerPixel"] = samples;
    metadata.attributes["renderTimeSeconds"] = static_cast<float>(seconds);
    metadata.attributes["pbrt.parts"] = static_cast<int>(parts.size());
    WriteImage(o.outfile, film->ToImage(), metadata);
    fmt::print("{}: {} per pixel from {}\n", o.outfile, CountText(samples, "sample"), CountText(parts.size(), "file"));
    return 0;
}

}  // namespace

void AddMerge(CLI::App &app, Action &action) {
    auto [command, o] = AddCommand(app, action, Merge, "merge", "Make the picture from the parts of a render",
                                   "Example: imgtool merge picture.exr part-*.chk");
    AddFlags(
        command,
        {Flag("outfile", o.outfile, "Picture: .exr, .png or .pfm").Required().Type("FILE"),
         Flag("parts", o.paths,
              "Files that pbrt --samples FIRST:END --checkpoint FILE wrote, in any order; together they must "
              "have every sample once")
             .Required()
             .Type("PART..."),
         {"--incomplete", o.incomplete, "Make the picture of the samples that there are, although some are missing"}});
}

}  // namespace pbrt::imgtool
