#include "ext/lab/lightlab/lightlab.h"
#include "pbrt/core/log.h"

int main(int argc, char **argv) { return pbrt::FinishOutput(ext::lab::RunLightlab(argc, argv)); }
