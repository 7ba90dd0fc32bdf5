#include "ext/lab/lightlab/lightlab.h"

int main(int argc, char **argv) { return ext::lab::RunLightlab(argc, argv); }
