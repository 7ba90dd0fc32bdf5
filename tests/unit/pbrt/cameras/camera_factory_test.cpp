#include "camera_cases.h"

namespace pbrt {
namespace {

using test::FloatParam;
using test::MakeTestCamera;
using test::StringParam;

std::string ErrorOf(const std::string &type, const std::vector<Param> &params) {
    try {
        MakeTestCamera(type, params);
    } catch (const UserError &e) {
        return e.what();
    }
    return "";
}

TEST(MakeCamera, KnownAndUnknownTypes) {
    for (const std::string &name : Cameras().Names())
        if (name != "realistic") {  // "realistic" needs a lens file
            EXPECT_TRUE(MakeTestCamera(name, {})) << name;
        }
    std::string unknown = ErrorOf("perspectiv", {});
    for (const std::string &name : Cameras().Names()) EXPECT_NE(unknown.find(name), std::string::npos) << name;
}

TEST(MakeCamera, SenselessValuesAreErrors) {
    EXPECT_NE(ErrorOf("perspective", {FloatParam("fov", {0})}), "");
    EXPECT_NE(ErrorOf("perspective", {FloatParam("fov", {180})}), "");
    EXPECT_NE(ErrorOf("perspective", {FloatParam("frameaspectratio", {0})}), "");
    EXPECT_NE(ErrorOf("perspective", {FloatParam("lensradius", {-1})}), "");
    EXPECT_NE(ErrorOf("perspective", {FloatParam("focaldistance", {0})}), "");
    EXPECT_NE(ErrorOf("perspective", {FloatParam("screenwindow", {-1, 1, -1})}), "");
    EXPECT_NE(ErrorOf("orthographic", {FloatParam("screenwindow", {1, 1, -1, 1})}), "");
    EXPECT_NE(ErrorOf("spherical", {StringParam("mapping", "cube")}).find("equirectangular"), std::string::npos);
}

TEST(MakeCamera, ShutterMustCloseAfterItOpens) {
    EXPECT_NE(ErrorOf("perspective", {FloatParam("shutteropen", {1})}).find("opens at 1 and closes at 1"),
              std::string::npos);
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
    const auto says = [](const std::string &type, const char *name, std::vector<Float> v, const char *part) {
        const std::string error = ErrorOf(type, {FloatParam(name, v)});
        EXPECT_NE(error.find(part), std::string::npos) << name << ": " << error;
    };
    says("perspective", "fov", {180}, "\"fov\" is 180; it must be above 0 and below 180");
    says("perspective", "lensradius", {1e30f}, "\"lensradius\" is 1e+30; it must be at least 0");
    says("perspective", "frameaspectratio", {1e30f}, "at most 1000000");
    for (const char *type : {"perspective", "orthographic", "spherical", "realistic"}) {
        says(type, "shutterclose", {2e9f},
             "\"shutterclose\" is 2000000000; it must be at least -1000000000 and at most 1000000000");
        says(type, "shutteropen", {-2e9f}, "\"shutteropen\" is -2000000000");
        says(type, "shutterclose", {Infinity}, "\"shutterclose\" is inf");
        says(type, "shutteropen", {std::nanf("")}, "\"shutteropen\" is nan");
    }
    says("orthographic", "screenwindow", {-1, 1e30f, -1, 1}, "\"screenwindow\" is 1e+30");
    // The focal distance is used only with a lens; without one, any value is accepted.
    EXPECT_EQ(ErrorOf("perspective", {FloatParam("focaldistance", {1e30f})}), "");
    EXPECT_NE(ErrorOf("perspective", {FloatParam("focaldistance", {1e30f}), FloatParam("lensradius", {0.1f})}), "");
}

}  // namespace
}  // namespace pbrt
