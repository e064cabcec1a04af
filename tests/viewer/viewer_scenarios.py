#!/usr/bin/env python3
"""What users do in the viewer, by mouse and keys on the real window; each asserts on the model and on pixels.

Usage: viewer_scenarios.py FATHOM [SCENARIO...]
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import scenarios_assisted  # noqa: E402
import scenarios_export  # noqa: E402
import scenarios_faults  # noqa: E402
import scenarios_live  # noqa: E402
import scenarios_looking  # noqa: E402
import scenarios_measurements  # noqa: E402
import scenarios_outlining  # noqa: E402
import scenarios_space  # noqa: E402
import scenarios_window  # noqa: E402
import scenarios_wire  # noqa: E402
from viewer_driver import run_all  # noqa: E402
from viewer_exams import Shared  # noqa: E402

TOPICS = [
    scenarios_looking, scenarios_outlining, scenarios_assisted, scenarios_measurements, scenarios_space, scenarios_window,
    scenarios_export, scenarios_live, scenarios_faults, scenarios_wire,
]

if __name__ == "__main__":
    sys.exit(run_all([scenario for topic in TOPICS for scenario in topic.SCENARIOS], sys.argv[1], Shared))
