#!/usr/bin/env bash
# Runs the tests of the trace on a device: the bits of the host for every example, shape and law, then contract and
# physics tests with all traces on the device; then round trips of fields. Usage: run.sh BUILD_DIR
set -euo pipefail

build=$1
engine=$build/libstraytrace_cuda.so
if ! "$build/straytrace" --version | grep -q '^cuda: .* GB$'; then
  echo 'skipped: no GPU'
  exit 0
fi
export STRAYTRACE_TEST_ENGINE=$engine
# Memory.* forks, and CUDA does not survive that; it measures the memory of the host.
export GTEST_FILTER=-Memory.*
for program in device_emulation unit_trace contract_geometry contract_optics physics_trace physics_world physics_results; do
  "$build/$program" --gtest_brief=1
done
# Fields, whose library the build leaves out where it finds no cuFFT.
waves=$build/libstraytrace_cufft.so
if [[ ! -e $waves ]]; then
  echo 'failed: there is a GPU, but the build found no cuFFT, so that its fields are not tested: install libcufft-dev of the'
  echo '  CUDA toolkit, or set STRAYTRACE_CUFFT and STRAYTRACE_CUFFT_INCLUDE; then build again'
  exit 1
fi
unset GTEST_FILTER
STRAYTRACE_TEST_WAVES=$waves "$build/unit_wave" --gtest_brief=1 --gtest_filter='DeviceTrip*'
