#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/core/state_file.h"
#include "pbrt/films/film_recipe.h"

namespace pbrt {

/// All that the samples of a render depend on, by name: "program", "file NAME" with the hash of its content, and
/// flags such as "--maxdepth".
using RenderIdentity = std::map<std::string, std::string>;

/// What differs, as parts of a sentence, separated by semicolons; empty if nothing does. `other` is called `otherName`.
std::string DifferencesOf(const RenderIdentity &mine, const RenderIdentity &other, const std::string &otherName);

/// The description of a render in its checkpoint. A complete checkpoint of a sample range can be merged with others.
struct RenderFileHead {
    RenderIdentity identity;
    int samplesFlag = 0;      ///< --spp of the first run, which decides the pattern of samples; 0: the scene's
    int samplesPerBatch = 1;  ///< of a pixel, in a batch of the pixel sampler
    int first = 0, end = 1;   ///< which samples were asked for; `end` 0: as many as a given time allows
    bool isPart = false;      ///< asked for by --samples
    int done = 0;             ///< the film has the samples [first, done) of every pixel
    int passCount = 0;        ///< see RenderPosition; passDone is a section of its own
    double seconds = 0;       ///< since the start of the program, added up over its runs
    double renderSeconds = 0;
    FilmRecipe film;
    ImageMetadata metadata;  ///< attributes of the picture that the film makes

    bool IsComplete() const { return (end == 0 || done == end) && passCount == 0; }
    /// Empty, or what is wrong with a head that was read.
    std::optional<std::string> Validate() const;
};

/// A checkpoint or part that was read.
class RenderFile {
  public:
    /// Throws UserError if the file is not a whole and undamaged checkpoint.
    explicit RenderFile(const std::string &path);

    const std::string &Path() const { return file_.Path(); }
    const RenderFileHead &Head() const { return head_; }
    /// See RenderPosition.
    std::vector<uint32_t> PassDone() const;
    /// Film::Load and Film::Merge of the sums. Throw UserError.
    void LoadFilm(Film &film) const;
    void MergeFilm(Film &film) const;
    /// What the light sampler has learned.
    StateReader Learned() const { return {file_.Section("learned"), Path()}; }

  private:
    /// Names the file in errors. Throws UserError if `read` leaves something, or makes a pixel that is not finite.
    void ReadFilm(Film &film, void (Film::*read)(std::istream &)) const;
    StateFile file_;
    RenderFileHead head_;
};

void WriteRenderFile(const std::string &path, const RenderFileHead &head, const std::vector<uint32_t> &passDone,
                     const Film &film, const StateWriter &learned);

}  // namespace pbrt
