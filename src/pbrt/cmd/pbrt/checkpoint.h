#pragma once
#include <chrono>
#include <optional>

#include "pbrt/build/built_scene.h"
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/films/render_file.h"

namespace pbrt {

/// The checkpoint of one render: read, if asked for, before the scene is built, and written while it is rendered.
class Checkpoint {
  public:
    /// Reads the file if the render is to be resumed and the file exists. Changes `build` so that the samples are those
    /// of the first run. `lightsHash`: of the file that --load-lights names, or empty. Throws UserError if the file is
    /// damaged or belongs to another render, or exists although nothing is said of resuming.
    Checkpoint(const CommandLine &options, const SceneDescription &description, const std::string &lightsHash,
               BuildOptions *build);

    bool IsResumed() const { return file_.has_value(); }
    const std::string &Path() const { return path_; }
    const RenderFileHead &Head() const { return head_; }
    /// Only if IsResumed(), and before Begin.
    StateReader Learned() const { return file_->Learned(); }
    /// After the integrator is prepared: loads the film and lets the settings go on from the file. Throws UserError.
    void Begin(const BuiltScene &built, RenderSettings *settings);
    /// Writes the file. A failure is a warning, as the next one may succeed; Failure() is of the last call.
    void Write(const BuiltScene &built, const RenderPosition &position, const ImageMetadata &metadata);
    const std::string &Failure() const { return failure_; }
    /// Of the runs before this one.
    double RenderSecondsBefore() const { return renderSecondsBefore_; }

  private:
    void TakeUp(const CommandLine &options, BuildOptions *build);

    std::string path_, failure_;
    RenderFileHead head_;
    std::optional<RenderFile> file_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), renderStart_;
    double secondsBefore_ = 0, renderSecondsBefore_ = 0;
    bool isTimed_ = false;
};

}  // namespace pbrt
