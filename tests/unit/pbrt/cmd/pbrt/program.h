#pragma once
#include <sys/types.h>

#include <vector>

#include "pbrt/images/image.h"
#include "support/errors.h"
#include "support/folder_test.h"
#include "support/scene_text.h"
#include "support/wait.h"

namespace pbrt::test {

struct Outcome {
    int status = -1;  ///< exit status; -signal if a signal ended it
    std::string out, err;
};

/// Runs the pbrt program in a temporary folder, which is removed after the test. A shell splits the arguments.
class Program : public FolderTest {
  protected:
    void SetUp() override;
    void TearDown() override;

    std::string Read(const std::string &name) const;
    bool Exists(const std::string &name) const { return std::filesystem::exists(folder_ / name); }
    /// The names of all files that the program left in the folder, sorted.
    std::vector<std::string> Files() const;

    Outcome Run(const std::string &arguments) const { return Wait(Start(arguments)); }
    /// Runs the program, expects success, and returns the messages.
    std::string RunWell(const std::string &arguments) const;
    struct ErrorCase {
        std::string arguments;
        std::vector<std::string> parts;  ///< parts of the message
    };
    /// Expects status 1, an error with all these parts, and no new file. The cases run at the same time.
    void ExpectErrors(const std::vector<ErrorCase> &cases, const std::string &flags = "--quiet ") const;
    /// The picture of a finished render with --time, rendered again without --time. `arguments`: of that render.
    ImageFile RenderWithoutClock(const std::string &arguments, const ImageFile &timed) const;
    /// Renders to `name` and reads the picture.
    ImageFile Render(const std::string &arguments, const std::string &name = "out.exr") const;

    /// The picture that imgtool merge makes. `arguments`: its name, then parts and flags.
    ImageFile Merged(const std::string &arguments) const;
    Outcome RunImgtool(const std::string &arguments) const;
    /// From now on mpirun starts the program as so many processes; 1: without mpirun. False if this build has no MPI.
    bool StartAs(int ranks, const std::string &wrapper = "");
    /// Expects that these numbers of processes give the bits and the attribute of one process, whose picture it
    /// returns.
    ImageFile ExpectSameBits(const std::string &arguments, const std::vector<int> &numbers,
                             const std::string &attribute = "samplesPerPixel");

    /// Starts the program without waiting for its end. `before`: shell commands to run before it, such as limits.
    pid_t Start(const std::string &arguments, const std::string &before = "true") const;
    Outcome Wait(pid_t pid) const;
    /// What a started process has written to standard error so far.
    std::string Messages(pid_t pid) const;
    /// True if the process runs the program (and not the shell before it) and handles SIGINT, SIGTERM and SIGHUP.
    static bool HandlesSignals(pid_t pid);
    /// Starts the program, and waits until it has written the file, new or anew.
    pid_t StartUntilWritten(const std::string &arguments, const std::string &name) const;
    /// Starts a render that writes out.exr and the checkpoint c.chk, sends it the first signal once there is a
    /// checkpoint, and resumes it for each further signal; at least one must end it before it is finished. Then lets it
    /// finish. Returns the messages of the last run.
    std::string StopAndResume(const std::string &arguments, const std::vector<int> &signals) const;

    std::string launcher_;  ///< a command that starts the program in place of the shell, such as mpirun

  private:
    pid_t StartCommand(const std::string &command) const;
    std::filesystem::path logs_;
};

/// A scene of 32 x 24 pixels and 4 samples: a sphere under a light of two triangles and a point light, written to
/// scene.exr. `integrator` is added to the parameters of the path integrator (line 5).
std::string SmallScene(const std::string &integrator = "");
/// The same with another film, and 80 small lamps that `octree` learns about while it renders.
std::string LearningScene(const std::string &film, int samples = 64);
/// A scene whose light comes from a part of the ceiling: there guided paths differ from plain ones.
std::string GuidedScene(int samples);
/// A view of the window, 1 by 1 in the wall at z = 2, of a room of 4 x 2 x 4 around the origin, under a sky of one
/// colour, written to x.exr.
std::string WindowScene(const std::string &eye, int maxDepth, const std::string &sky);

bool Has(const std::string &text, const std::string &part);
/// Replaces the first place of `from`, which must be there.
std::string Replaced(std::string text, const std::string &from, const std::string &to);
size_t CountOf(const std::string &text, const std::string &part);
int IntOf(const ImageFile &file, const std::string &attribute);
double NumberOf(const ImageFile &file, const std::string &attribute);
std::string TextOf(const ImageFile &file, const std::string &attribute);
/// True if all stored values have equal bits.
bool SamePixels(const ImageFile &a, const ImageFile &b);
/// The output of --list-lightsamplers; the program is run only once for it.
const std::string &LightSamplerListing();
inline bool HasExt() { return Has(LightSamplerListing(), "\noctree\n"); }

/// With SmallScene in scene.pbrt.
class SmallSceneProgram : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        Write("scene.pbrt", SmallScene());
    }
};

/// With flags for a light sampler, which learns while it renders if this build has such a one.
class LearningProgram : public Program {
  protected:
    const bool ext_ = HasExt();
    const std::string lights_ = ext_ ? " --lightsampler octree " : " --lightsampler bvh ";
};

}  // namespace pbrt::test

/// Skips a test of features that only src/ext has. Every summary shows skipped tests.
#define PBRT_SKIP_WITHOUT_EXT()  \
    if (!::pbrt::test::HasExt()) \
    GTEST_SKIP() << "NOT TESTED: this build has no src/ext (PBRT_EXT=OFF), so no octree and no mesh lights"
