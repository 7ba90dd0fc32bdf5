#include "program.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace pbrt::test {

namespace {

std::string FileText(const std::filesystem::path &path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// See SmallScene; `lamps`: further lights.
std::string BallUnderLamps(const std::string &film, int samples, const std::string &integrator,
                           const std::string &lamps = "") {
    return SceneText()
        .LookAt("0 1 -5  0 0 0  0 1 0")
        .Camera(40)
        .Film(32, 24, "'string filename' 'scene.exr' 'bool savefp16' false", film)
        .Head(fmt::format("Sampler 'zsobol' 'integer pixelsamples' {}", samples))
        .Integrator("path", 3, integrator)
        .World(Objects()
                   .PointLight("-2 2 -2", "2 3 4")
                   .Diffuse("0.6 0.4 0.3")
                   .Shape("sphere")
                   .Quad("-4 -1 -4  4 -1 -4  -4 -1 4  4 -1 4")
                   .Attribute(
                       "",
                       Objects().AreaLight("6 5 4", "'bool twosided' true").Triangles("-1 3 -1  1 3 -1  1 3 1  -1 3 1"))
                   .Add(lamps));
}

template <class T>
T AttributeOf(const ImageFile &file, const std::string &attribute) {
    const std::optional<T> value = file.metadata.Attribute<T>(attribute);
    EXPECT_TRUE(value) << "the file has no such attribute " << attribute;
    return value.value_or(T{});
}

}  // namespace

void Program::SetUp() {
    logs_ = folder_ / "logs";
    folder_ /= "work";
    for (const std::filesystem::path &folder : {folder_, logs_}) std::filesystem::create_directory(folder);
}

void Program::TearDown() { std::filesystem::remove_all(folder_.parent_path()); }

std::string Program::Read(const std::string &name) const { return FileText(folder_ / name); }

std::vector<std::string> Program::Files() const {
    std::vector<std::string> names;
    for (const auto &entry : std::filesystem::directory_iterator(folder_)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

pid_t Program::StartCommand(const std::string &command) const {
    const pid_t pid = fork();
    if (pid != 0) return pid;
    alarm(60);  // exec keeps the alarm, so a program that hangs is ended, and the test fails
    const std::string log = (logs_ / std::to_string(getpid())).string();
    const std::string whole = fmt::format("cd '{0}' && {1} > {2}.out 2> {2}.err", folder_.string(), command, log);
    execl("/bin/sh", "sh", "-c", whole.c_str(), nullptr);
    _exit(127);
}

pid_t Program::Start(const std::string &arguments, const std::string &before) const {
    return StartCommand(before + " && exec " + launcher_ + " '" PBRT_PROGRAM "' " + arguments);
}

Outcome Program::RunImgtool(const std::string &arguments) const {
    return Wait(StartCommand("exec '" PBRT_IMGTOOL "' " + arguments));
}

bool Program::StartAs([[maybe_unused]] int ranks, [[maybe_unused]] const std::string &wrapper) {
#ifdef PBRT_MPIRUN
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    launcher_ =
        ranks == 1 ? "" : fmt::format("'{}' --oversubscribe --bind-to none -n {} {}", PBRT_MPIRUN, ranks, wrapper);
    return true;
#else
    return false;
#endif
}

ImageFile Program::ExpectSameBits(const std::string &arguments, const std::vector<int> &numbers,
                                  const std::string &attribute) {
    StartAs(1);
    ImageFile one = Render(arguments + " --nthreads 1");
    for (const int ranks : numbers) {
        SCOPED_TRACE(fmt::format("{}, {} processes", arguments, ranks));
        StartAs(ranks);
        const ImageFile many = Render(arguments + " --nthreads " + (ranks == 2 ? "3" : "1"));
        EXPECT_TRUE(SamePixels(one, many));
        EXPECT_EQ(one.metadata.attributes.at(attribute), many.metadata.attributes.at(attribute));
    }
    return one;
}

Outcome Program::Wait(pid_t pid) const {
    int raw = 0;
    EXPECT_EQ(waitpid(pid, &raw, 0), pid);
    const std::string log = std::to_string(pid);
    return {WIFEXITED(raw) ? WEXITSTATUS(raw) : -WTERMSIG(raw), FileText(logs_ / (log + ".out")),
            FileText(logs_ / (log + ".err"))};
}

std::string Program::Messages(pid_t pid) const { return FileText(logs_ / (std::to_string(pid) + ".err")); }

std::string Program::RunWell(const std::string &arguments) const {
    const Outcome o = Run(arguments);
    EXPECT_EQ(o.status, 0) << arguments << "\n" << o.err;
    EXPECT_FALSE(Has(o.err, "Error")) << arguments << "\n" << o.err;
    return o.err;
}

void Program::ExpectErrors(const std::vector<ErrorCase> &cases, const std::string &flags) const {
    const std::vector<std::string> before = Files();
    std::vector<pid_t> running;
    for (const ErrorCase &c : cases) running.push_back(Start(flags + c.arguments));
    for (size_t i = 0; i < cases.size(); ++i) {
        const Outcome o = Wait(running[i]);
        SCOPED_TRACE(cases[i].arguments + "\n" + o.err);
        EXPECT_EQ(o.status, 1);
        EXPECT_EQ(o.out, "");
        EXPECT_TRUE(Has(o.err, "Error: "));
        ExpectWords(o.err, cases[i].parts);
    }
    EXPECT_EQ(Files(), before);
}

ImageFile Program::RenderWithoutClock(const std::string &arguments, const ImageFile &timed) const {
    const int planned = IntOf(timed, "pbrt.plannedSamplesPerPixel"), taken = IntOf(timed, "samplesPerPixel");
    const std::string kept = arguments + " --checkpoint again --spp ", again = " --outfile again.exr" + kept;
    if (taken < planned) {
        RunWell(fmt::format("{}{} --samples 0:{}", kept, planned, taken));
        Merged("again.exr --incomplete again");
    } else {
        RunWell(again + std::to_string(planned));
        RunWell(again + std::to_string(taken) + " --resume");
    }
    std::filesystem::remove(Path("again"));
    return ReadImage(Path("again.exr"));
}

ImageFile Program::Render(const std::string &arguments, const std::string &name) const {
    RunWell("--outfile " + name + " " + arguments);
    return ReadImage(Path(name));
}

ImageFile Program::Merged(const std::string &arguments) const {
    const Outcome merged = RunImgtool("merge " + arguments);
    EXPECT_EQ(merged.status, 0) << arguments << "\n" << merged.err;
    return ReadImage(Path(arguments.substr(0, arguments.find(' '))));
}

bool Program::HandlesSignals(pid_t pid) {
    std::error_code gone;
    if (std::filesystem::read_symlink("/proc/" + std::to_string(pid) + "/exe", gone) !=
        std::filesystem::canonical(PBRT_PROGRAM))
        return false;
    std::ifstream status("/proc/" + std::to_string(pid) + "/status");
    const auto bit = [](int signal) { return 1ull << (signal - 1); };
    const unsigned long long handled = bit(SIGINT) | bit(SIGTERM) | bit(SIGHUP);
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("SigCgt:")) return (std::stoull(line.substr(7), nullptr, 16) & handled) == handled;
    return false;
}

pid_t Program::StartUntilWritten(const std::string &arguments, const std::string &name) const {
    const auto time = [file = Path(name)] {
        std::error_code none;  // the least time
        return std::filesystem::last_write_time(file, none);
    };
    const auto before = time();
    const pid_t pid = Start(arguments);
    EXPECT_TRUE(WaitUntil([&] { return time() != before; })) << Messages(pid);
    return pid;
}

std::string Program::StopAndResume(const std::string &arguments, const std::vector<int> &signals) const {
    const std::string resumed = arguments + " --outfile out.exr --checkpoint c.chk --resume";
    int stopped = 0;
    for (const int signal : signals) {
        const pid_t pid = StartUntilWritten(resumed + " --checkpoint-interval 0.01", "c.chk");
        kill(pid, signal);
        const int status = Wait(pid).status;
        if (status == 0) continue;
        ++stopped;
        EXPECT_EQ(status, signal == SIGKILL ? -SIGKILL : 128 + signal);
    }
    EXPECT_GT(stopped, 0) << arguments;
    return RunWell(resumed);
}

std::string SmallScene(const std::string &integrator) { return BallUnderLamps("rgb", 4, integrator); }

std::string LearningScene(const std::string &film, int samples) {
    Objects lamps;
    for (int i = 0; i < 80; ++i) lamps.PointLight(fmt::format("{} 2 {}", i % 10 - 5, i / 10 - 4), "0.1 0.2 0.1");
    return BallUnderLamps(film, samples, "", lamps);
}

std::string GuidedScene(int samples) {
    return SceneText()
        .LookAt("0 1.2 -2.8  0 .8 0  0 1 0")
        .Camera(60)
        .Film(48, 48, "'string filename' 'guided.exr'")
        .Samples(samples)
        .Integrator("path", 4)
        .World(Objects()
                   .Light("spot",
                          "'point3 from' [ 0 .6 0 ] 'point3 to' [ 1 2 1 ] 'rgb I' [ 60 60 60 ] 'float coneangle' 32")
                   .Material("diffuse")
                   .Quad(room::kCeiling)
                   .Quad(room::kFloor)
                   .Quad(room::kBack));
}

std::string WindowScene(const std::string &eye, int maxDepth, const std::string &sky) {
    Objects world;
    world.Sky(sky);
    for (const char *wall :
         {"-2 -1 -2  2 -1 -2  -2 -1 2  2 -1 2", "-2 1 -2  2 1 -2  -2 1 2  2 1 2", "-2 -1 -2  -2 1 -2  -2 -1 2  -2 1 2",
          "2 -1 -2  2 1 -2  2 -1 2  2 1 2", "-2 -1 -2  2 -1 -2  -2 1 -2  2 1 -2", "-2 -1 2  -.5 -1 2  -2 1 2  -.5 1 2",
          ".5 -1 2  2 -1 2  .5 1 2  2 1 2", "-.5 -1 2  .5 -1 2  -.5 -.5 2  .5 -.5 2",
          "-.5 .5 2  .5 .5 2  -.5 1 2  .5 1 2"})
        world.Quad(wall);
    return SceneText()
        .LookAt(eye + "  0 0 2  0 1 0")
        .Camera(80)
        .Samples(16)
        .Integrator("path", maxDepth)
        .Film(48, 48, "'string filename' 'x.exr'")
        .World(world);
}

bool Has(const std::string &text, const std::string &part) { return text.find(part) != std::string::npos; }

std::string Replaced(std::string text, const std::string &from, const std::string &to) {
    EXPECT_TRUE(Has(text, from)) << from;
    return text.replace(text.find(from), from.size(), to);
}

size_t CountOf(const std::string &text, const std::string &part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
    return count;
}

int IntOf(const ImageFile &file, const std::string &attribute) { return AttributeOf<int>(file, attribute); }
double NumberOf(const ImageFile &file, const std::string &attribute) {
    return double(AttributeOf<float>(file, attribute));
}
std::string TextOf(const ImageFile &file, const std::string &attribute) {
    return AttributeOf<std::string>(file, attribute);
}

bool SamePixels(const ImageFile &a, const ImageFile &b) {
    return a.image.Bytes() == b.image.Bytes() && a.image.Bytes() > 0 && a.image.Channels() == b.image.Channels() &&
           std::memcmp(a.image.Data(), b.image.Data(), a.image.Bytes()) == 0;
}

const std::string &LightSamplerListing() {
    static const std::string listing = [] {
        std::string text = "\n";
        std::FILE *pipe = popen("'" PBRT_PROGRAM "' --list-lightsamplers", "r");
        std::array<char, 4096> buffer;
        while (size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe)) text.append(buffer.data(), got);
        EXPECT_EQ(pclose(pipe), 0);
        return text;
    }();
    return listing;
}

}  // namespace pbrt::test
