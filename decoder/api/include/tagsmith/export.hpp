// SPDX-License-Identifier: Apache-2.0
// Marks what the shared libraries export: all else in them is hidden.
#pragma once

#define TAGSMITH_EXPORT __attribute__((visibility("default")))
