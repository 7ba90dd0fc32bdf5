#pragma once
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/core/state_file.h"
#include "pbrt/films/film.h"
#include "pbrt/films/sample_plan.h"

namespace pbrt {

/// Everything besides the sums that determines a film's image, so that it can be made without the scene.
struct FilmRecipe {
    std::string type;
    ParamSet params;
    std::string colorSpace = "srgb";
    Float exposureTime = 1;  ///< seconds
    FilmOverrides overrides;

    /// Creates an empty film that makes the same image of the same sums; samples cannot be added.
    std::unique_ptr<Film> Make() const;
    void Visit(auto &archive) { archive(type, params, colorSpace, exposureTime, overrides); }
};

/// Everything that determines a render's samples: "program", "file NAME" with a hash, and flags such as "--maxdepth".
using RenderIdentity = std::map<std::string, std::string>;

/// Differences as clauses separated by semicolons, calling `other` `otherName`; empty if equal.
std::string DifferencesOf(const RenderIdentity &mine, const RenderIdentity &other, const std::string &otherName);

/// Description of a render in its checkpoint. Complete checkpoints of sample ranges can be merged.
struct RenderFileHead {
    RenderIdentity identity;
    int samplesFlag = 0;      ///< --spp of the first run, which determines the sample pattern; 0: the scene's
    int samplesPerBatch = 1;  ///< per pixel, in a batch of the pixel sampler
    int first = 0, end = 1;   ///< requested samples; `end` 0: open; attribute pbrt.interrupted until finished
    bool isPart = false;      ///< requested by --samples
    int done = 0;             ///< the film holds samples [first, done) of every pixel
    int passCount = 0;        ///< see RenderPosition; passDone is a separate section
    double seconds = 0;       ///< since program start, accumulated over runs
    double renderSeconds = 0;
    FilmRecipe film;
    ImageMetadata metadata;  ///< attributes of the output image

    void Visit(auto &archive) {
        archive(identity, samplesFlag, samplesPerBatch, first, end, isPart, done, passCount, seconds, renderSeconds,
                film, metadata.attributes);
    }
    /// Returns the error of an invalid head; empty if valid.
    std::optional<std::string> Validate() const {
        const auto isTime = [](double s) { return s >= 0 && std::isfinite(s); };
        if (samplesFlag < 0 || samplesPerBatch < 1 || first < 0 || done < first || passCount < 0 ||
            passCount > std::numeric_limits<int>::max() - done || end < 0 || (end > 0 && (end <= first || end < done)))
            return "its sample counts are invalid";
        return isTime(seconds) && isTime(renderSeconds) ? std::nullopt : std::optional("its times are invalid");
    }
};

class RenderFile {
  public:
    /// Throws UserError if the file is incomplete or damaged.
    explicit RenderFile(const std::string &path);

    const std::string &Path() const { return file_.Path(); }
    const RenderFileHead &Head() const { return head_; }
    std::vector<uint32_t> PassDone() const {
        std::vector<uint32_t> done;
        StateReader in(file_.Section("pass"), Path());
        in.Structure(done);
        in.RequireEnd();
        return done;
    }
    /// Film::Load and Film::Merge of the sums. Throw UserError.
    void LoadFilm(Film &film) const { ReadFilm("film", film, &Film::Load); }
    void MergeFilm(Film &film) const { ReadFilm("film", film, &Film::Merge); }
    /// Of an adaptive render: its plan, and the half film. Throw UserError.
    SamplePlan Plan(const PixelCells &cells) const {
        SamplePlan plan;
        StateReader in(file_.Section("plan"), Path());
        in(plan);
        in.RequireEnd();
        in.RequireValid(plan.Validate(cells, head_.done));
        return plan;
    }
    void LoadHalf(Film &half) const { ReadFilm("half film", half, &Film::Load); }
    /// Learned state of the light sampler.
    StateReader Learned() const { return {file_.Section("learned"), Path()}; }

  private:
    /// Throws UserError if `read` fails or leaves data, or a pixel becomes non-finite.
    void ReadFilm(const char *section, Film &film, void (Film::*read)(StateReader &)) const {
        StateReader in(file_.Section(section), Path());
        (film.*read)(in);
        in.RequireEnd();
        const Image colors = film.Colors();
        ForEachValue(colors, [&](Point2i p, int c) {
            in.Require(std::isfinite(colors.Get(p, c)), "a pixel of its film is not finite");
        });
    }
    StateFile file_;
    RenderFileHead head_;
};

/// State of an adaptive render besides its film.
struct AdaptiveState {
    const SamplePlan &plan;
    const Film &half;
};

/// `adaptive`: null for other renders.
void WriteRenderFile(const std::string &path, const RenderFileHead &head, const std::vector<uint32_t> &passDone,
                     const Film &film, const StateWriter &learned, const AdaptiveState *adaptive = nullptr);

}  // namespace pbrt
