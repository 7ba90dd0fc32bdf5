#include "camera_cases.h"

#include "support/errors.h"

namespace pbrt {
namespace {

using test::FloatParam;
using test::MakeTestCamera;
using test::StringParam;

std::string ErrorOf(const std::string &type, const std::vector<Param> &params) {
    return test::MessageOf([&] { MakeTestCamera(type, params); });
}

TEST(MakeCamera, KnownAndUnknownTypes) {
    for (const std::string &name : Cameras().Names())
        if (name != "realistic") {  // "realistic" needs a lens file
            EXPECT_TRUE(MakeTestCamera(name, {})) << name;
        }
    std::string unknown = ErrorOf("perspectiv", {});
    for (const std::string &name : Cameras().Names()) EXPECT_NE(unknown.find(name), std::string::npos) << name;
}

TEST(MakeCamera, ShutterMustCloseAfterItOpens) {
    test::ExpectWords(ErrorOf("perspective", {FloatParam("shutteropen", {1})}), {"opens at 1 and closes at 1"});
    for (const char *type : {"perspective", "orthographic", "spherical"})
        EXPECT_NE(ErrorOf(type, {FloatParam("shutteropen", {3}), FloatParam("shutterclose", {2})})
                      .find("opens at 3 and closes at 2"),
                  std::string::npos)
            << type;
    auto camera =
        MakeTestCamera("perspective", {FloatParam("shutteropen", {2}), FloatParam("shutterclose", {3})}, {4, 4});
    EXPECT_EQ(camera->ShutterOpen(), 2);
    EXPECT_EQ(camera->ShutterClose(), 3);
}

TEST(MakeCamera, UnusedParametersAreErrors) {
    DiagnosticSink sink;
    MakeTestCamera("orthographic", {FloatParam("fov", {30})}, {4, 4}, {}, &sink);
    EXPECT_EQ(sink.ErrorCount(), 1u);
    MakeTestCamera("perspective", {FloatParam("lensradus", {30})}, {4, 4}, {}, &sink);
    EXPECT_EQ(sink.ErrorCount(), 2u);
    MakeTestCamera(
        "spherical",
        {FloatParam("lensradius", {3}), FloatParam("focaldistance", {3}), FloatParam("screenwindow", {0, 1, 0, 1}),
         FloatParam("frameaspectratio", {1}), FloatParam("shutterclose", {2})},
        {4, 4}, {}, &sink);
    EXPECT_EQ(sink.ErrorCount(), 2u);
}

TEST(MakeCamera, NumbersOutsideTheirRangesAreErrors) {
    const auto says = [](const std::string &type, const std::string &name, std::vector<Float> v,
                         std::vector<std::string> words) {
        words.push_back("\"" + name + "\"");
        test::ExpectWords(ErrorOf(type, {FloatParam(name, std::move(v))}), words);
    };
    says("perspective", "fov", {0}, {"above 0"});
    says("perspective", "fov", {180}, {"180", "above 0", "below 180"});
    says("perspective", "lensradius", {-1}, {"at least 0"});
    says("perspective", "frameaspectratio", {0}, {"at most 1000000"});
    says("perspective", "focaldistance", {0}, {"above 0"});
    EXPECT_NE(ErrorOf("perspective", {FloatParam("screenwindow", {-1, 1, -1})}), "");
    says("orthographic", "screenwindow", {1, 1, -1, 1}, {});
    says("perspective", "lensradius", {1e30f}, {"1e+30", "at least 0"});
    says("perspective", "frameaspectratio", {1e30f}, {"at most 1000000"});
    for (const char *type : {"perspective", "orthographic", "spherical", "realistic"}) {
        says(type, "shutterclose", {2e9f}, {"2000000000", "at least -1000000000", "at most 1000000000"});
        says(type, "shutteropen", {-2e9f}, {"-2000000000"});
        says(type, "shutterclose", {Infinity}, {"inf"});
        says(type, "shutteropen", {std::nanf("")}, {"nan"});
    }
    says("orthographic", "screenwindow", {-1, 1e30f, -1, 1}, {"\"screenwindow\" is 1e+30"});
    test::ExpectWords(ErrorOf("spherical", {StringParam("mapping", "cube")}), {"equirectangular"});
    // The focal distance is used only with a lens; without one, any value is accepted.
    EXPECT_EQ(ErrorOf("perspective", {FloatParam("focaldistance", {1e30f})}), "");
    EXPECT_NE(ErrorOf("perspective", {FloatParam("focaldistance", {1e30f}), FloatParam("lensradius", {0.1f})}), "");
}

}  // namespace
}  // namespace pbrt
