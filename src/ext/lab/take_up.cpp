#include "ext/lab/take_up.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include "pbrt/core/count_text.h"
#include "pbrt/core/log.h"

namespace pbrt::lab {

namespace {

bool IsWholeFilm(const std::string &file, const LabScene &scene) {
    std::ifstream in(file, std::ios::binary);
    if (!in) return false;
    try {
        scene.built.film->MakeRgbFilm()->Load(in);
        return true;
    } catch (const UserError &) {
        return false;
    }
}

}  // namespace

bool IsFinite(const Image &picture) {
    for (int y = 0; y < picture.Resolution().y; ++y)
        for (int x = 0; x < picture.Resolution().x; ++x)
            for (int c = 0; c < 3; ++c)
                if (!std::isfinite(picture.Get({x, y}, c))) return false;
    return true;
}

bool IsWholePicture(const std::string &file, Point2i resolution) {
    if (!std::filesystem::exists(file)) return false;
    try {
        const Image picture = ReadImage(file).image.Select({"R", "G", "B"});
        return picture.Resolution() == resolution && IsFinite(picture);
    } catch (const UserError &) {
        return false;
    }
}

RunRecord TakeUpRun(const RecordFolder &records, const LabScene &scene, const std::string &sampler, int seed,
                    size_t checkpoints, const std::string &picture) {
    RunRecord run = records.LoadRun(sampler, seed);
    const size_t recorded = records.CountRounds(sampler, seed, checkpoints);
    auto canGoOn = [&](size_t rounds) {
        if (rounds == checkpoints) return IsWholePicture(picture, scene.Resolution());
        return IsWholeFilm(records.FilmFile(sampler, seed, static_cast<int>(rounds) - 1), scene);
    };
    size_t kept = std::min(run.rounds.size(), checkpoints);
    while (kept > 0 && !canGoOn(kept)) --kept;
    if (recorded > kept)
        LogWarning(fmt::format(
            "{}/{}: records of seed {} are damaged or missing; {}.", records.Folder(), sampler, seed,
            kept > 0 ? fmt::format("going on from {} per pixel", CountText(run.rounds[kept - 1].samples, "sample"))
                     : "this run begins anew"));
    // Reports and structure must be those of the last round that is kept.
    if (kept < run.rounds.size()) run = records.LoadRun(sampler, seed, static_cast<int>(kept));
    records.RemoveRounds(sampler, seed, kept, checkpoints);
    return run;
}

}  // namespace pbrt::lab
