#pragma once
#include <chrono>
#include <memory>

#include "pbrt/build/built_scene.h"
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/films/render_file.h"

namespace pbrt {

/// The checkpoint of one render: read with --resume before the scene is built, and written while it is rendered.
class Checkpoint {
  public:
    /// Reads the file if the render is resumed and the file exists. Changes `build` so that the samples are those of
    /// the first run. `lightsHash`: of the file that --load-lights names, or empty. Throws UserError if the file is
    /// damaged, belongs to another render, or exists without --resume.
    static Checkpoint Open(const CommandLine &options, const SceneDescription &description,
                           const std::string &lightsHash, BuildOptions *build);

    bool IsResumed() const { return file_ != nullptr; }
    const std::string &Path() const { return path_; }
    const RenderFileHead &Head() const { return head_; }
    /// Only if IsResumed(), and before Begin.
    StateReader Learned() const { return file_->Learned(); }
    /// Loads the film and sets the position at which `settings` resume; the integrator must be prepared. Throws
    /// UserError.
    void Begin(const BuiltScene &built, RenderSettings *settings);
    /// Writes the file. A failure is logged as a warning; Failure() is the message of the last call.
    void Write(const BuiltScene &built, const RenderPosition &position, const ImageMetadata &metadata);
    const std::string &Failure() const { return failure_; }
    /// Seconds of rendering in earlier runs.
    double RenderSecondsBefore() const { return renderSecondsBefore_; }

  private:
    Checkpoint() = default;
    void Resume(const CommandLine &options, BuildOptions *build);

    std::string path_, failure_;
    RenderFileHead head_;
    std::unique_ptr<RenderFile> file_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), renderStart_;
    double secondsBefore_ = 0, renderSecondsBefore_ = 0;
    bool isTimed_ = false;
};

}  // namespace pbrt
