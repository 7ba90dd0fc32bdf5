#include <signal.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pbrt/core/progress.h"
#include "support/errors.h"
#include "unit/pbrt/cmd/pbrt/program.h"

namespace pbrt::test {

namespace {

class Lightlab : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        Write("scene.pbrt", SmallScene());
        setenv("XDG_CACHE_HOME", Path("cache").c_str(), 1);  // the cache of the user must not be used
    }
    /// The file names of the references in a folder.
    std::vector<std::string> ReferencesIn(const std::string &folder) const {
        std::vector<std::string> names;
        if (std::filesystem::exists(Path(folder)))
            for (const auto &entry : std::filesystem::directory_iterator(Path(folder)))
                if (Has(entry.path().filename().string(), ".reference-"))
                    names.push_back(entry.path().filename().string());
        return names;
    }
    nlohmann::json Results(const std::string &folder) const {
        return nlohmann::json::parse(Read(folder + "/results.json"));
    }
    bool SamePictures(const std::string &a, const std::string &b) const {
        return SamePixels(ReadImage(Path(a)), ReadImage(Path(b)));
    }
};

const std::string kSmall = "--samplers uniform,power --spp 4 --seeds 2 --reference-spp 32 --no-report ";

}  // namespace

TEST_F(Lightlab, ComparesAndPrintsATable) {
    const Outcome o = Run("scene.pbrt " + kSmall);
    ASSERT_EQ(o.status, 0) << o.err;
    ExpectWords(o.out, {"sampler", "relL2", "speed-up", "uniform", "power", "reference 0", "bias"});
    const nlohmann::json r = Results("scene-lab");
    EXPECT_EQ(r.at("scene"), "scene.pbrt");
    EXPECT_TRUE(Has(r.at("commandLine"), "--reference-spp 32"));
    EXPECT_EQ(r.at("samplers").size(), 2u);
    const std::string csv = Read("scene-lab/results.csv"), rounds = Read("scene-lab/rounds.csv");
    EXPECT_EQ(CountOf(csv, "\n"), 3u);
    EXPECT_EQ(CountOf(rounds, "\n"), 1u + 2 * 2 * 3);
    const size_t header = csv.find('\n'), row = csv.find('\n', header + 1);
    EXPECT_EQ(CountOf(csv.substr(0, row), ","), 2 * CountOf(csv.substr(0, header), ","));
}

TEST_F(Lightlab, WorksWithEveryIntegratorThatSamplesLights) {
    const std::string experiment =
        "--samplers uniform,power --spp 2 --seeds 2 --reference-spp 4 --selection-work 100000 --divisor 4 --no-report --out "
        "lab-";
    for (const std::string integrator : {"path", "volpath", "bdpt", "mlt", "sppm"}) {
        std::string scene = SmallScene();
        scene.replace(scene.find("\"path\""), 6, '"' + integrator + '"');
        Write("other.pbrt", scene);
        RunWell("other.pbrt " + experiment + integrator);
        const nlohmann::json results = Results("lab-" + integrator);
        for (const nlohmann::json &s : results.at("samplers"))
            EXPECT_GT(s.at("summary").at("metrics").at("relL2").at("mean").get<double>(), 0) << integrator;
        RunWell("noise other.pbrt --samplers uniform --spp 2 --seeds 2 --divisor 4 --out noise-" + integrator);
        RunWell("inspect other.pbrt --sampler power --samples 2 --out inspect-" + integrator);
        bool hasVertices = false;
        const nlohmann::json inspection = nlohmann::json::parse(Read("inspect-" + integrator + "/inspect.json"));
        for (const nlohmann::json &layer : inspection.at("layers")) hasVertices |= layer.at("name") == "path.vertices";
        EXPECT_EQ(hasVertices, integrator != "bdpt" && integrator != "mlt") << integrator;
    }
}

TEST_F(Lightlab, IntegratorsWithoutLightSamplerAreErrors) {
    for (const std::string integrator :
         {"lightpath", "simplepath", "simplevolpath", "randomwalk", "ambientocclusion"}) {
        std::string scene = SmallScene();
        const std::string from = "\"path\" \"integer maxdepth\" 3";
        scene.replace(scene.find(from), from.size(), '"' + integrator + '"');
        Write(integrator + ".pbrt", scene);
        const std::vector<std::string> words = {integrator + ".pbrt:5:0: ", '"' + integrator + '"', "no light sampler",
                                                "\"path\""};
        for (const std::string &arguments :
             {integrator + ".pbrt " + kSmall, "noise " + integrator + ".pbrt --samplers uniform --spp 2 --seeds 2",
              "inspect " + integrator + ".pbrt --sampler power"}) {
            const Outcome o = Run(arguments);
            EXPECT_EQ(o.status, 1) << arguments;
            ExpectWords(o.err, words);
            EXPECT_FALSE(Has(o.err, "Warning")) << o.err;
        }
    }
}

TEST_F(Lightlab, QuietPrintsTheTableOnly) {
    const Outcome o = Run("scene.pbrt --quiet " + kSmall);
    EXPECT_EQ(o.status, 0);
    EXPECT_EQ(o.err, "");
    EXPECT_TRUE(Has(o.out, "uniform"));
}

TEST_F(Lightlab, ReferencesAreKeptInTheCacheOrTheGivenFolder) {
    RunWell("scene.pbrt --out one " + kSmall);
    EXPECT_EQ(ReferencesIn("cache/pbrt_octree").size(), Results("one").at("references").size());
    EXPECT_TRUE(ReferencesIn(".").empty());
    RunWell("scene.pbrt --out two --cache mine " + kSmall);
    EXPECT_EQ(ReferencesIn("mine"), ReferencesIn("cache/pbrt_octree"));
    EXPECT_TRUE(Has(Results("two").at("references").at(0).at("source"), "mine/scene.reference-"));
    RunWell("scene.pbrt --out three --cache \"\" " + kSmall);
    EXPECT_EQ(ReferencesIn("three"), ReferencesIn("mine"));
    const Outcome o = Run("scene.pbrt --out four --cache scene.pbrt " + kSmall);
    EXPECT_EQ(o.status, 0);
    EXPECT_TRUE(Has(o.err, "cannot be kept there")) << o.err;
    EXPECT_EQ(ReferencesIn("four"), ReferencesIn("mine"));
}

TEST_F(Lightlab, AResumedExperimentHasTheSameImages) {
    const std::string arguments =
        "scene.pbrt --samplers uniform,power --spp 512 --seeds 1 --reference-spp 64 --no-report --out ";
    RunWell(arguments + "whole");
    for (int signal : {SIGKILL, SIGINT}) {
        const std::string out = signal == SIGKILL ? "killed" : "interrupted";
        const pid_t pid = Start(arguments + out);
        ASSERT_TRUE(WaitUntil([&] { return Exists(out + "/records/power/seed0-round03.json"); }));
        kill(pid, signal);
        const Outcome o = Wait(pid);
        EXPECT_EQ(o.status, signal == SIGKILL ? -SIGKILL : 130) << o.err;
        EXPECT_FALSE(Exists(out + "/results.json"));
        const std::string messages = RunWell(arguments + out);
        EXPECT_TRUE(Has(messages, "resuming from")) << messages;
        for (const char *picture : {"/uniform/seed0.exr", "/power/seed0.exr", "/reference-0.exr"})
            EXPECT_TRUE(SamePictures("whole" + std::string(picture), out + picture)) << out << picture;
    }
}

TEST_F(Lightlab, EverySignalEndsItSoonWithItsStatus) {
    ASSERT_EQ(mkfifo(Path("pipe").c_str(), 0600), 0);
    const auto isReading = [](pid_t) { return true; };
    const std::pair<const char *, std::function<bool(pid_t)>> cases[] = {
        {"pipe --no-report --samplers uniform", isReading},
        {"inspect pipe --sampler uniform", isReading},
        {"scene.pbrt --no-report --samplers uniform --spp 100000000 --seeds 1 --reference-spp 100000000 --out long",
         [&](pid_t) { return Exists("long/records"); }},
        {"inspect scene.pbrt --sampler uniform --samples 1000000",
         [&](pid_t pid) { return Has(Messages(pid), "building: done"); }}};
    for (int signal : {SIGINT, SIGTERM, SIGHUP})
        for (const auto &[arguments, isAtWork] : cases) {
            std::filesystem::remove_all(Path("long"));
            const pid_t pid = Start(arguments);
            EXPECT_TRUE(WaitUntil([pid, &isAtWork = isAtWork] { return HandlesSignals(pid) && isAtWork(pid); }))
                << Messages(pid);
            const auto start = std::chrono::steady_clock::now();
            kill(pid, signal);
            const Outcome o = Wait(pid);
            EXPECT_LT(SecondsSince(start), 5) << arguments;
            EXPECT_EQ(o.status, 128 + signal) << arguments << "\n" << o.err;
            EXPECT_TRUE(Has(o.err, "Interrupted")) << arguments << "\n" << o.err;
            for (const auto &entry : std::filesystem::recursive_directory_iterator(Path(".")))
                EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path() << ": a temporary file";
        }
}

TEST_F(Lightlab, SamplersMayBePartedBySemicolons) {
    RunWell(
        "scene.pbrt --samplers 'bvh+mesh;octree:budget=0.02,floor=0.2;neepp:samples=3,voxels=9,uniform' --spp 1 --seeds 1 "
        "--reference-spp 8 --no-report --selection-work 0 --out out");
    const nlohmann::json results = Results("out");
    std::vector<std::string> labels;
    for (const nlohmann::json &s : results.at("samplers")) labels.push_back(s.at("label"));
    EXPECT_EQ(labels, (std::vector<std::string>{"bvh+mesh", "octree:budget=0.02,floor=0.2", "neepp:samples=3,voxels=9",
                                                "uniform"}));
}

TEST_F(Lightlab, ExamplesOfTheHelpAreRight) {
    for (const char *scene : {"a.pbrt", "b.pbrt", "c.pbrt"}) Write(scene, SmallScene());
    int examples = 0;
    for (const char *page : {"--help", "inspect --help", "noise --help"}) {
        std::istringstream help(Run(page).out);
        for (std::string line; std::getline(help, line);) {
            if (!line.starts_with("  lightlab ")) continue;
            std::string command = line.substr(11, line.find("   ", 11) - 11);
            if (const size_t time = command.find("--time 20"); time != std::string::npos)
                command.replace(time, 9, "--time 0.2 --seeds 1");
            if (Has(command, "noise")) command += " --spp 4 --seeds 2";
            else if (!Has(command, "inspect"))
                command += " --no-report --divisor 4 --reference-spp 8 --selection-work 0 --restart --out out";
            EXPECT_FALSE(Has(RunWell(command), "no effect")) << command;
            ++examples;
        }
    }
    EXPECT_GE(examples, 4);
}

TEST_F(Lightlab, SamplesOfATimedExperimentCanBeReplayed) {
    RunWell("scene.pbrt --samplers uniform,power --time 0.2 --seeds 2 --reference-spp 32 --no-report --out timed");
    const nlohmann::json timed = Results("timed");
    EXPECT_EQ(timed.at("mode"), "time");
    RunWell("scene.pbrt --samples-from timed/results.json --no-report --out replay");
    for (const char *picture : {"/uniform/seed0.exr", "/uniform/seed1.exr", "/power/seed0.exr", "/power/seed1.exr"})
        EXPECT_TRUE(SamePictures("timed" + std::string(picture), "replay" + std::string(picture))) << picture;
    const nlohmann::json replay = Results("replay");
    for (size_t i = 0; i < 2; ++i)
        EXPECT_EQ(replay["samplers"][i]["summary"]["metrics"], timed["samplers"][i]["summary"]["metrics"]);
    // More samples than the four of the scene, so later batches are needed, too.
    EXPECT_GT(timed["samplers"][0]["runs"][0]["rounds"].back()["samples"], 4);
    const Outcome more = Run("scene.pbrt --samples-from timed/results.json --seeds 3 --no-report --out more");
    EXPECT_EQ(more.status, 1);
    EXPECT_TRUE(Has(more.err, "seed 2")) << more.err;
    const std::string before = Read("timed/results.json");
    ExpectErrors({{"scene.pbrt --samples-from timed/results.json --restart --out timed",
                   {"--samples-from timed/results.json: ", "--out"}},
                  {"scene.pbrt --samples-from timed/results.json --spp 2 --out other", {"--samples-from", "--spp"}},
                  {"scene.pbrt --reference ./timed/reference-0.exr --restart --out timed",
                   {"--reference ./timed/reference-0.exr: ", "--out"}}});
    EXPECT_EQ(Read("timed/results.json"), before);
}

TEST_F(Lightlab, AdviceOnFewOracleSamplesFitsTheBudget) {
    RunWell("scene.pbrt --samplers uniform,oracle:samples=1 --spp 2 --seeds 1 --reference-spp 8 --no-report --out few");
    const std::string remarks = Results("few").at("conclusion").at("remarks").dump();
    EXPECT_TRUE(Has(remarks, "took only 2.0 samples per pixel")) << remarks;
    EXPECT_TRUE(Has(remarks, "use more --spp")) << remarks;
    EXPECT_FALSE(Has(remarks, "equal samples")) << remarks;
}

TEST_F(Lightlab, MistakesAreReportedTogetherAndNothingIsRendered) {
    Write("sweep.txt", "uniform # comment\n\nnosuch\npower:leaves=3\n");
    ExpectErrors(
        {{"scene.pbrt --samplers-file sweep.txt", {"nosuch", "uniform", "leaves", "2 errors; nothing was rendered."}},
         {"scene.pbrt --samplers bvh,bvh", {"bvh", "twice"}},
         {"scene.pbrt --samplers 'bvh+mush;bvh+gate=neepp;bvh+guide:length=2'",
          {"+mush", "+mesh", "+gate", "length", "3 errors"}},
         {"scene.pbrt --time 1 --spp 2", {"--time", "--spp"}},
         {"scene.pbrt --reference r.exr --reference-spp 2", {"--reference-spp and --reference exclude"}},
         {"scene.pbrt --reference r.exr --cache c", {"--cache and --reference exclude"}},
         {"scene.pbrt --direct --maxdepth 2", {"--direct", "--maxdepth 1"}},
         {"scene.pbrt --spp 0", {"--spp: \"0\" is not an integer from 1 to 2147483647", "--help"}},
         {"scene.pbrt --time 1e400", {"--time: \"1e400\" is not a finite number above 0"}},
         {"scene.pbrt --out ''", {"--out: the value is empty"}},
         {"scene.pbrt --seeds two", {"--seeds", "two"}},
         {"scene.pbrt --nthreads -1", {"--nthreads: \"-1\" is not an integer from 0 to 2147483647"}},
         {"scene.pbrt --crops 1,2,3", {"--crops", "1,2,3"}},
         {"scene.pbrt --crops 0,0,99,9 --samplers bvh", {"--crops", "32 x 24"}},
         {"scene.pbrt --reference none.exr --samplers bvh", {"none.exr"}},
         {"scene.pbrt --samples-from sweep.txt", {"sweep.txt", "results.json"}},
         {"nosuch.pbrt --samplers bvh", {"nosuch.pbrt"}},
         {"", {"scene"}}});
    EXPECT_TRUE(Has(Run("inspect scene.pbrt --sampler bvhh").err, "Error: --sampler:1:0"));
    ExpectErrors({{"inspect scene.pbrt --divisor 1e3", {"--divisor: \"1e3\" is not an integer from 1 to 2147483647"}},
                  {"noise scene.pbrt --seeds 1", {"--seeds: \"1\" is not an integer from 2 to 1000"}}},
                 "");
    EXPECT_FALSE(std::filesystem::exists(Path("scene-lab")));
}

/// The work would take hours.
TEST_F(Lightlab, AFolderThatCannotBeWrittenIsFoundBeforeTheWork) {
    ExpectErrors({{"noise scene.pbrt --samplers uniform --spp 100000000 --out scene.pbrt/n", {"scene.pbrt/n: Not a"}},
                  {"inspect scene.pbrt --sampler uniform --samples 100000000 --out scene.pbrt", {"scene.pbrt: Not a"}},
                  {"inspect scene.pbrt --sampler uniform --samples 100000000 --out /proc/self", {"/proc/self"}}},
                 "");
}

TEST_F(Lightlab, AFailureOfStandardOutputIsAnError) {
    launcher_ = R"(sh -c 'exec "$0" "$@" > /dev/full')";
    for (const char *arguments : {"--version", "noise --help",
                                  "scene.pbrt --samplers uniform --spp 1 --seeds 1 "
                                  "--reference-spp 8 --selection-work 0 --no-report"}) {
        const Outcome o = Run(arguments);
        EXPECT_EQ(o.status, 1) << arguments;
        ExpectWords(o.err, {"Error:", "standard output"});
    }
}

TEST_F(Lightlab, NumbersOutOfRangeAreShownWhereTheyWereWritten) {
    EXPECT_TRUE(Has(Run("inspect scene.pbrt --sampler octree:leaves=-4").err, "--sampler:1:7"));
    ExpectErrors({{"scene.pbrt --samplers uniform,octree:leaves=0",
                   {"--samplers:1:7", "octree.leaves", "at least 64 and at most"}},
                  {"scene.pbrt --samplers uniform+guide:share=2", {"--samplers:1:14", "guide.share"}}});
    EXPECT_FALSE(std::filesystem::exists(Path("scene-lab")));
}

TEST_F(Lightlab, HelpNamesEveryFlag) {
    const Outcome o = Run("--help");
    EXPECT_EQ(o.status, 0);
    ExpectWords(o.out, {"--samplers", "--samplers-file", "--time", "--spp", "--seeds", "--direct", "--maxdepth",
                        "--divisor", "--reference", "--reference-spp", "--cache", "--out", "--crops", "--restart",
                        "--samples-from", "--nthreads", "--quiet", "inspect"});
    EXPECT_EQ(Run("inspect --help").status, 0);
    EXPECT_TRUE(Run("--version").out.starts_with("pbrt_octree "));
    ExpectErrors({{"scene.pbrt --sppp 3", {"--sppp", "did you mean --spp?"}},
                  {"scene.pbrt --refrence-spp 3", {"did you mean --reference-spp?"}},
                  {"scene.pbrt --lightsampler octree", {"--samplers lists"}},
                  {"inspect scene.pbrt --divisr 2", {"did you mean --divisor?"}},
                  {"noise scene.pbrt --seds 2", {"--seds", "did you mean --seeds?"}}});
}

TEST_F(Lightlab, MissingScriptsCostTheReportOnly) {
    const auto expectNoReport = [&](const std::string &out, const char *variable, const std::string &value,
                                    const std::vector<std::string> &words) {
        setenv(variable, value.c_str(), 1);
        const Outcome o = Run("scene.pbrt --samplers uniform --spp 1 --seeds 1 --reference-spp 8 --out " + out);
        unsetenv(variable);
        EXPECT_EQ(o.status, 0);
        ExpectWords(o.err, words);
        EXPECT_TRUE(Exists(out + "/results.json"));
    };
    expectNoReport("one", "LIGHTLAB_REPORT_SCRIPTS", Path("nowhere"), {"charts.py is missing"});
    // A report of earlier results does not pass for one of these.
    for (const char *file : {"one/report.html", "one/table.md", "one/chart-crops.png"}) Write(file, "old");
    expectNoReport("one", "LIGHTLAB_REPORT_SCRIPTS", Path("nowhere"), {"charts.py is missing"});
    for (const char *file : {"one/report.html", "one/table.md", "one/chart-crops.png"}) EXPECT_FALSE(Exists(file));
    expectNoReport("two", "LIGHTLAB_PYTHON", "/nonexistent/python", {"/nonexistent/python", "not started"});
}

TEST_F(Lightlab, AScriptEndsWithIt) {
    // A script in place of Python that writes its process id to a file and then sleeps for a minute.
    Write("script.sh", "#!/bin/sh\necho $$ > id.tmp\nmv id.tmp id\nexec sleep 60\n");
    std::filesystem::permissions(Path("script.sh"), std::filesystem::perms::owner_all);
    auto runs = [](pid_t pid) {
        std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
        std::string id, name, state;
        // Z: the process has ended, but its parent has not waited for it.
        return stat >> id >> name >> state && state != "Z";
    };
    for (int signal : {SIGINT, SIGTERM, SIGHUP, SIGKILL}) {
        std::filesystem::remove(Path("id"));
        setenv("LIGHTLAB_PYTHON", Path("script.sh").c_str(), 1);
        const pid_t pid = Start("scene.pbrt --samplers uniform --spp 1 --seeds 1 --reference-spp 8 --out out");
        unsetenv("LIGHTLAB_PYTHON");
        EXPECT_TRUE(WaitUntil([&] { return Exists("id"); })) << Messages(pid);
        const pid_t script = std::stoi(Read("id"));
        EXPECT_TRUE(runs(script));
        kill(pid, signal);
        const Outcome o = Wait(pid);
        EXPECT_EQ(o.status, signal == SIGKILL ? -SIGKILL : 128 + signal) << o.err;
        EXPECT_EQ(Has(o.err, "has no report yet"), signal != SIGKILL) << o.err;
        EXPECT_TRUE(WaitUntil([&] { return !runs(script); })) << "after signal " << signal;
    }
}

TEST_F(Lightlab, ReportIsMade) {
    if (std::system("/usr/bin/python3 -c 'import matplotlib' 2> /dev/null") != 0)
        GTEST_SKIP() << "NOT TESTED: /usr/bin/python3 has no matplotlib";
    const Outcome o = Run("scene.pbrt --samplers uniform,power --spp 2 --seeds 2 --reference-spp 16 --out out");
    ASSERT_EQ(o.status, 0) << o.err;
    EXPECT_TRUE(Exists("out/report.html"));
    EXPECT_TRUE(Exists("out/chart-error-time.svg"));
    // The page and the table contain every sentence of the terminal, word by word.
    const std::string page = Read("out/report.html"), table = Read("out/table.md");
    for (const std::string sentence : Results("out").at("conclusion").at("sentences")) {
        EXPECT_TRUE(Has(o.out, sentence)) << sentence << "\n" << o.out;
        std::string escaped;
        for (char c : sentence) escaped += c == '"' ? "&quot;" : std::string(1, c);
        EXPECT_TRUE(Has(page, escaped)) << sentence;
        EXPECT_TRUE(Has(table, sentence)) << sentence;
    }
}

TEST_F(Lightlab, SeveralScenesMakeOneTableAndAPage) {
    std::filesystem::create_directory(Path("other"));
    Write("b<2>.pbrt", SmallScene());
    Write("other/scene.pbrt", SmallScene());
    const std::string scenes = "scene.pbrt 'b<2>.pbrt' other/scene.pbrt ";
    const Outcome o = Run(scenes + kSmall);
    ASSERT_EQ(o.status, 0) << o.err;
    const std::string table = o.out.substr(o.out.rfind("All scenes"));
    ExpectWords(table,
                {"\nscene ", "\nscene-2 ", "\nb<2> ", "uniform", "power", "\nover uniform ", "4 samples per pixel"});
    EXPECT_TRUE(Has(o.err, "Wrote scenes-lab/index.html."));
    const nlohmann::json all = nlohmann::json::parse(Read("scenes-lab/scenes.json"));
    ASSERT_EQ(all["scenes"].size(), 3u);
    double product = 1;
    for (const auto &scene : all["scenes"]) {
        const nlohmann::json r = Results("scenes-lab/" + scene["folder"].get<std::string>());
        EXPECT_EQ(r["conclusion"]["headline"], scene["headline"]);
        EXPECT_TRUE(Has(table, r["conclusion"]["headline"]));
        product *= r["samplers"][1]["summary"]["metrics"]["relL2"]["mean"].get<double>() /
                   r["samplers"][0]["summary"]["metrics"]["relL2"]["mean"].get<double>();
    }
    EXPECT_TRUE(Has(table.substr(table.find("over uniform")), fmt::format("{:.3g}\n", std::cbrt(product)))) << table;
    const std::string csv = Read("scenes-lab/scenes.csv"), page = Read("scenes-lab/index.html");
    EXPECT_EQ(CountOf(csv, "\n"), 1u + 3 * 2);
    ExpectWords(page, {"href=\"scene/results.json\"", "src=\"b&lt;2&gt;/reference-0.png\"", "<tfoot>"});
    EXPECT_FALSE(Has(page, "b<2>"));
    // The same command renders nothing again.
    const Outcome again = Run(scenes + kSmall);
    EXPECT_EQ(again.out, o.out);
}

TEST_F(Lightlab, InspectionsOfVariantsHaveFoldersOfTheirOwn) {
    for (const std::string sampler : {"uniform", "uniform+guide"}) {
        RunWell("inspect scene.pbrt --samples 1 --divisor 4 --sampler " + sampler);
        EXPECT_EQ(nlohmann::json::parse(Read("inspect-" + sampler + "/inspect.json"))["sampler"], sampler);
    }
}

TEST_F(Lightlab, InspectionPrintsNoNumbersOfLayersWithoutValues) {
    Write("away.pbrt", "Rotate 180 0 1 0\n" + SmallScene());
    const std::string table = Run("inspect away.pbrt --samples 1 --divisor 4 --sampler uniform").out;
    EXPECT_TRUE(Has(table, fmt::format("{:<28} {:>12} {:>12} {:>12}\n", "entropy", "-", "-", "-"))) << table;
}

TEST_F(Lightlab, SampledLightNeedsAnIntegratorThatHasIt) {
    Write("bdpt.pbrt", Replaced(SmallScene(), "\"path\"", "\"bdpt\""));
    const Outcome o = Run("bdpt.pbrt --sampled-light " + kSmall);
    EXPECT_EQ(o.status, 1);
    ExpectWords(o.err, {"--sampled-light", "\"bdpt\"", "\"path\"", "\"sppm\""});
}

TEST_F(Lightlab, OneSeedHasNoStandardError) {
    Write("b.pbrt", SmallScene());
    const Outcome o =
        Run("scene.pbrt b.pbrt --samplers uniform --spp 1 --seeds 1 --reference-spp 8 --selection-work 0 --no-report");
    EXPECT_FALSE(Has(o.out, "+- 0")) << o.out;
    EXPECT_FALSE(Has(Read("scenes-lab/index.html"), "±"));
    EXPECT_TRUE(Has(Read("scenes-lab/scenes.csv"), ",,0,"));
}

TEST_F(Lightlab, AWrongSceneKeepsNoOtherFromBeingCompared) {
    Write("wrong.pbrt", SmallScene() + "Shape \"ball\"\nShape \"egg\"\n");
    const Outcome o = Run("wrong.pbrt scene.pbrt --out all " + kSmall);
    EXPECT_EQ(o.status, 1);
    EXPECT_TRUE(Has(o.err, "\"ball\"")) << o.err;
    EXPECT_TRUE(Has(o.out, "wrong: failed. ")) << o.out;
    EXPECT_EQ(Results("all/scene").at("samplers").size(), 2u);
    EXPECT_TRUE(Has(Read("all/index.html"), "ball"));
    const std::string failure = nlohmann::json::parse(Read("all/scenes.json"))["scenes"][0]["failure"];
    ExpectWords(failure, {"wrong.pbrt:", "\"ball\"", "\nError: wrong.pbrt:", "\"egg\""});
    // A name that is misspelt is found before anything is rendered.
    ExpectErrors({{"scene.pbrt scnee.pbrt --out none", {"scnee.pbrt: No such file"}},
                  {"scene.pbrt wrong.pbrt --reference r.exr", {"--reference", "one scene", "2 are given"}},
                  {"scene.pbrt wrong.pbrt --crops 0,0,4,4", {"--crops", "one scene"}}});
}

}  // namespace pbrt::test
