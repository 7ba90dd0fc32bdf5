#include "camera_cases.h"

#include "support/errors.h"

namespace pbrt::test {
namespace {

std::string CameraError(const std::string &type, const ParamSet &params = Params()) {
    return MessageOf([&] { MakeTestCamera(type, params); });
}

TEST(MakeCamera, ValidAndUnknownTypes) {
    for (const std::string &name : Cameras().Names())
        if (name != "realistic") {  // "realistic" needs a lens file
            EXPECT_TRUE(MakeTestCamera(name)) << name;
        }
    ExpectWords(CameraError("perspectiv"), Cameras().Names());
}

TEST(MakeCamera, ShutterMustCloseAfterItOpens) {
    ExpectWords(CameraError("perspective", Params().Number("shutteropen", 1)), {"opens at 1 and closes at 1"});
    for (const char *type : {"perspective", "orthographic", "spherical"})
        ExpectWords(CameraError(type, Params().Number("shutteropen", 3).Number("shutterclose", 2)),
                    {"opens at 3 and closes at 2"});
}

TEST(MakeCamera, UnusedParametersAreErrors) {
    DiagnosticSink sink;
    MakeTestCamera("orthographic", Params().Number("fov", 30), {4, 4}, {}, &sink);
    EXPECT_EQ(sink.ErrorCount(), 1u);
    MakeTestCamera("perspective", Params().Number("lensradus", 30), {4, 4}, {}, &sink);
    EXPECT_EQ(sink.ErrorCount(), 2u);
    MakeTestCamera("spherical",
                   Params()
                       .Number("lensradius", 3)
                       .Number("focaldistance", 3)
                       .Floats(ParamType::Float, "screenwindow", {0, 1, 0, 1})
                       .Number("frameaspectratio", 1)
                       .Number("shutterclose", 2),
                   {4, 4}, {}, &sink);
    EXPECT_EQ(sink.ErrorCount(), 2u);
}

TEST(MakeCamera, NumbersOutsideTheirRangesAreErrors) {
    const auto expectWords = [](const std::string &type, const std::string &name, std::vector<Float> v,
                                std::vector<std::string> words) {
        words.push_back("\"" + name + "\"");
        ExpectWords(CameraError(type, Params().Floats(ParamType::Float, name, std::move(v))), words);
    };
    expectWords("perspective", "fov", {0}, {"above 0"});
    expectWords("perspective", "fov", {180}, {"180", "above 0", "below 180"});
    expectWords("perspective", "lensradius", {-1}, {"at least 0"});
    expectWords("perspective", "frameaspectratio", {0}, {"at most 1000000"});
    expectWords("perspective", "focaldistance", {0}, {"above 0"});
    EXPECT_NE(CameraError("perspective", Params().Floats(ParamType::Float, "screenwindow", {-1, 1, -1})), "");
    expectWords("orthographic", "screenwindow", {1, 1, -1, 1}, {});
    expectWords("perspective", "lensradius", {1e30f}, {"1e+30", "at least 0"});
    expectWords("perspective", "frameaspectratio", {1e30f}, {"at most 1000000"});
    for (const char *type : {"perspective", "orthographic", "spherical", "realistic"}) {
        expectWords(type, "shutterclose", {2e9f}, {"2000000000", "at least -1000000000", "at most 1000000000"});
        expectWords(type, "shutteropen", {-2e9f}, {"-2000000000"});
        expectWords(type, "shutterclose", {Infinity}, {"inf"});
        expectWords(type, "shutteropen", {std::nanf("")}, {"nan"});
    }
    expectWords("orthographic", "screenwindow", {-1, 1e30f, -1, 1}, {"\"screenwindow\" is 1e+30"});
    ExpectWords(CameraError("spherical", Params().String("mapping", "cube")), {"equirectangular"});
    // The focal distance is used only with a lens; without one, any value is accepted.
    EXPECT_EQ(CameraError("perspective", Params().Number("focaldistance", 1e30f)), "");
    EXPECT_NE(CameraError("perspective", Params().Number("focaldistance", 1e30f).Number("lensradius", 0.1f)), "");
}

}  // namespace
}  // namespace pbrt::test
