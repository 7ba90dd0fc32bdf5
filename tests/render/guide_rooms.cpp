#include "guide_rooms.h"

namespace pbrt::test {

const std::string kSpotAtCeiling =
    "LightSource \"spot\" \"point3 from\" [ 0 .6 0 ] \"point3 to\" [ 1 2 1 ] \"rgb I\" [ 60 60 60 ] "
    "\"float coneangle\" 32 \"float conedeltaangle\" 3";
const std::string kPanelBehindCurtain =
    "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 8 8 8 ] \"bool twosided\" true "
    "Shape \"bilinearmesh\" \"point3 P\" [ 1 .1 1  2 .1 1  1 1 1  2 1 1 ] AttributeEnd\n"
    "Material \"diffusetransmission\" Shape \"bilinearmesh\" \"point3 P\" [ .8 0 -1  .8 0 3  .8 1.6 -1  .8 1.6 3 ]";

std::string GuideRoomText(const GuideRoom &room) {
    const std::string medium =
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [ .3 .25 .2 ] "
        "\"rgb sigma_a\" [ .02 .02 .04 ] \"float g\" .4\nMediumInterface \"\" \"fog\"\n";
    const std::string back = room.window
                                 ? "Shape \"bilinearmesh\" \"point3 P\" [ -3 0 3  3 0 3  -3 .8 3  3 .8 3 ]\n"
                                   "Shape \"bilinearmesh\" \"point3 P\" [ -3 1.7 3  3 1.7 3  -3 2 3  3 2 3 ]\n"
                                   "Shape \"bilinearmesh\" \"point3 P\" [ -3 .8 3  .5 .8 3  -3 1.7 3  .5 1.7 3 ]\n"
                                   "Shape \"bilinearmesh\" \"point3 P\" [ 1.5 .8 3  3 .8 3  1.5 1.7 3  3 1.7 3 ]\n"
                                 : "Shape \"bilinearmesh\" \"point3 P\" [ -3 0 3  3 0 3  -3 2 3  3 2 3 ]\n";
    return R"(Option "rendercoordsys" "world"
LookAt 0 1.2 -2.8  0 0.8 0  0 1 0
)" + (room.fog ? medium : "") +
           R"(Camera "perspective" "float fov" 60
Film "rgb" "integer xresolution" 48 "integer yresolution" 48 "bool savefp16" false
Sampler "independent" "integer pixelsamples" 64
Integrator ")" +
           (room.fog ? "volpath" : "path") + "\" \"integer maxdepth\" 4 " + room.parameters + "\nWorldBegin\n" +
           room.light + "\n" + room.walls + R"(
Shape "bilinearmesh" "point3 P" [ -3 2 -3  3 2 -3  -3 2 3  3 2 3 ]
Shape "bilinearmesh" "point3 P" [ -3 0 -3  3 0 -3  -3 2 -3  3 2 -3 ]
)" + back + R"(
Shape "bilinearmesh" "point3 P" [ 3 0 -3  3 0 3  3 2 -3  3 2 3 ]
Shape "bilinearmesh" "point3 P" [ -3 0 -3  -3 0 3  -3 2 -3  -3 2 3 ]
)" + room.floor +
           R"(
Shape "bilinearmesh" "point3 P" [ -3 0 -3  3 0 -3  -3 0 3  3 0 3 ]
)";
}

}  // namespace pbrt::test
