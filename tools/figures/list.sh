# The figures of the pages: tools/figures.sh reads this file and says what its words mean. `data` are
# 300 real frames, euroc/MH_01_easy_t05_t20 in the folder of recorded data; `slow` takes minutes.
# Tables have all their columns: 1000 fit, and all their lines.
# No figure shows the host's times, the commit, or anything else that differs from run to run.

# README.md
figure what-if
needs data
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded'
shows 'leviosim whatif recorded cluster.fpu.units=1,2,8 cluster.icache.shared_size=8KiB'
cut 'sed -n "/^in short/p;/^  *mean ms/,/^next/p" | grep -v -e "^next" -e "^    [^ ]"'

figure l1-levio
needs data
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded'
shows 'leviosim whatif recorded cluster.l1.size=32,48,64,96,192,256KiB'
cut 'sed -n "/^  *mean ms/,/^next/p" | grep -v -e "^next" -e "^    [^ ]"'

figure l1-next
needs data
after 'leviosim run --profile next --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out tracked'
shows 'leviosim whatif tracked cluster.l1.size=32,48,64,96,192,256KiB'
cut 'sed -n "/^  *mean ms/,/^next/p" | grep -v -e "^next" -e "^    [^ ]"'

figure missed-deadlines
needs data
shows 'COLUMNS=80 leviosim tune --data euroc/MH_01_easy_t05_t20 --clock 130,370 --fps 10 --seed 1,2,3,4,5,6,7,8,9,10 --out tuned'
cut 'lines "^frames/s" "^ *10 +[0-9]" | sed -E "s/  meets limits.*//"'

figure sweep
needs data
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded
cat >clocks.yaml <<YAML
base: { trace: recorded }
points:
  - list:
      - { platform.cluster.clock: 240MHz, platform.controller.clock: 240MHz, platform.supply.voltage: 0.65V }
      - { platform.cluster.clock: 370MHz }
    grid:
      platform.cluster.fpu.units: [1, 4]
YAML'
shows 'leviosim sweep clocks.yaml --out clocks'
cut 'sed -n "/^point/,/^all of them/p"'

# sim/VALIDATION.md
figure paper-compute
needs data
shows 'leviosim validate --data euroc/MH_01_easy_t05_t20'
cut 'table stage'

figure paper-compute-keypoints
needs data
shows 'leviosim validate --data euroc/MH_01_easy_t05_t20'
cut 'sed "1,/number of keypoints (/d" | table stage'

figure paper-others
needs data
shows 'leviosim validate --data euroc/MH_01_easy_t05_t20'
cut 'table quantity quantity unit paper simulated error within | grep -v occupation'

figure paper-units
needs data
shows 'leviosim validate --data euroc/MH_01_easy_t05_t20'
cut 'table "cycles of" | sed "/^How to read/,\$d"'

figure paper-bands
needs data
shows 'leviosim validate --data euroc/MH_01_easy_t05_t20'
cut 'sed -n "/^kcycles with the band/,/lie inside/p"'

figure more-keypoints
needs data
shows 'leviosim validate --fit -p workload.fast_threshold=15 -p workload.harris_threshold=4000 --data euroc/MH_01_easy_t05_t20'
cut 'sed -n "/^in short/p;/^stage, 1 core/,\$p"'

figure breakdown
needs data
shows 'leviosim run --platform gap9 -p workload.released=on --data euroc/MH_01_easy_t05_t20 \
      --tables all --out released'
cut 'sed "1,/^where the core-cycles go/d" | table stage stage useful code FPU divider "L1 banks" "slowest core" DMA serial'

figure sensitivity
needs data
shows 'leviosim sensitivity --data euroc/MH_01_easy_t05_t20 --frames 0:100'
cut 'table number number confidence value range frame optimiser | first 10'

figure calibrate
needs data
shows 'leviosim validate --fit --data euroc/MH_01_easy_t05_t20'
cut 'sed -n "/^in short/p;/^stage, 1 core/,\$p"'

figure microbench
shows 'leviosim microbench'
cut 'lines "^GAP.: " "^PULP-DSP: "'

figure coverage
shows 'leviosim microbench'
cut 'sed -n "/^published cycles of kernels/,\$p"'

figure gap8-board
shows 'leviosim microbench'
cut 'sed "1,/^PULP-DSP: /d; /^GAP8: /,\$d; /^─/d; /^$/d; s/  *\(SDK-12\|source\).*//" | awk "!/cores  unit/ || !header++" | outside_tolerance'

# workload/ACCURACY.md
figure next-stages
needs data
shows 'leviosim run --platform gap9 --profile next --data euroc/MH_01_easy_t05_t20 --tables all --out next'
cut 'table stage stage calls "kcycles, 1 core" "kcycles, 8 cores" speed-up ms "worst ms"'

figure next-error
needs data
shows 'leviosim run --platform gap9 --profile next --data euroc/MH_01_easy_t05_t20 --tables all --out next'
cut 'lines ^ATE without SE3'

figure levio-error
needs data
shows 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --tables all --out tables'
cut 'lines ^ATE SE3'

figure next-memory
needs data
shows 'leviosim run --platform gap9 --profile next --data euroc/MH_01_easy_t05_t20 --tables all --out next'
cut 'table peak | rows ^feature ^triangulation "L2  "'

figure seeds
needs data
shows 'leviosim ablate --data euroc/MH_01_easy_t05_t20 --profile levio,next --seed 1,2,3,4,5,6,7,8 --out seeds'
cut 'sed "/^  /d" | table sequence profile runs diverged "absolute [m]" least greatest'

figure ablation
needs data
shows 'leviosim ablate --data euroc/MH_01_easy_t05_t20 --align sim3 --relative 2 --out ablated'
cut 'sed "/^  /d" | table sequence profile runs diverged "absolute [m]" least greatest'

figure flights-recorded
needs data slow
shows 'leviosim benchmark-flights recorded --motions euroc --out real'
cut 'sed "/^  /d" | table profile profile piece set pieces "ATE %" from to "worst %" diverged'

# platform_models/CHIPS.md
figure chips
shows 'leviosim platforms list'

figure feasibility
needs data
shows 'leviosim platforms feasibility --data euroc/MH_01_easy_t05_t20'
cut 'table chip chip cores MHz "frame ms" worst published "optimiser ms" frames/s mJ/frame mW'

figure feasibility-memory
needs data
shows 'leviosim platforms feasibility --data euroc/MH_01_easy_t05_t20'
cut 'table chip chip cores memory | rows "[0-9]+.kB|in tiles"'

figure accelerators
needs data
shows 'leviosim platforms stages gap9 gap9-eigen gap9-hamming gap9-corners --data euroc/MH_01_easy_t05_t20'
cut 'table "kilocycles of a call"'

figure systems
needs data
shows 'leviosim platforms systems --data euroc/MH_01_easy_t05_t20 --report systems.html'
cut 'table system'

# workload/flow/VALIDATION.md
figure flow
needs data
shows 'leviosim flow --platform gap8 -p cluster.clock=50MHz -p controller.clock=50MHz \
      -p supply.voltage=1.0V --data euroc/MH_01_easy_t05_t20 --fps 500 --out flow'
cut 'table figure figure cores MHz unit published here "difference %"'

# tools/COMMANDS.md
figure tune-table
needs data slow
shows 'leviosim tune --data euroc/MH_01_easy_t05_t20 --clock 130:370:30 --fps 10,15,20 --seed 1,2,3 --out tuned'
cut 'table frames/s | rows " (130|160|250|310|370)  "'

figure tune-choice
needs data slow
shows 'leviosim tune --data euroc/MH_01_easy_t05_t20 --clock 130:370:30 --fps 10,15,20 --seed 1,2,3 --out tuned'
cut 'sed -n "/^the lowest clocks/,/^run again/p"'

figure replay
needs data
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded'
shows 'leviosim replay recorded -p controller.clock=100MHz --tables stages --out slow-controller'
cut 'sed -n "/^replay of/,/^stages/p" | first 10'

figure trace-info
needs data
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded'
shows 'leviosim trace info recorded/work.trace'
cut 'sed 1d'

figure eval
needs data
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded'
shows 'leviosim eval recorded euroc/MH_01_easy_t05_t20 --relative 1'

figure flow-stages
needs data
shows 'leviosim flow --platform gap8 -p cluster.clock=50MHz -p controller.clock=50MHz \
      -p supply.voltage=1.0V --data euroc/MH_01_easy_t05_t20 --fps 500 --out flow'
cut 'table stage stage call "kcycles, 1 core" "kcycles, 8 cores" speed-up ms'

figure profiles
shows 'leviosim workload'
cut 'sed -n "/^profiles/,/^$/p" | sed "/^$/d"'

figure compare
needs data
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded'
shows 'leviosim compare recorded -p cluster.fpu.dividers=2'

figure check
needs data
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded
leviosim budget record recorded >baseline.json
cat >budgets.yaml <<YAML
budgets:
  - platform: gap9
    owner: front end
    limits:
      - frame latency p99 <= 50 ms
      - L1 peak <= 110 kB
      - stage: "*RANSAC"
        limit: cycles <= +3 %
        reason: room for the next camera
YAML'
shows 'leviosim check recorded -p isa.ops.f32_fma.issue=1.8 --budget budgets.yaml \
      --baseline baseline.json || echo "exit status $?"'

# tools/STORIES.md
figure story-divider
needs data
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded'
shows 'leviosim compare recorded -p cluster.fpu.dividers=2 --report divider.html'
cut 'sed -n "/^work:/,\$p"'

figure story-clock
needs data slow
shows 'leviosim tune --profile next --data euroc/MH_01_easy_t05_t20 --clock 130:370:60 --fps 20 --ate 0.15 --out clock'
cut 'table frames/s frames/s MHz V "missed %" "p99 ms" mW mJ/frame "ATE m" "meets limits"'

figure story-choice
needs data slow
shows 'leviosim tune --profile next --data euroc/MH_01_easy_t05_t20 --clock 130:370:60 --fps 20 --ate 0.15 --out clock'
cut 'sed -n "/^verdict/,/^leviosim/{/^leviosim/!p};/^it held/,/^run again/p"'

figure story-gate
needs data
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded
leviosim budget record recorded >baseline.json
cat >epnp.yaml <<YAML
budgets:
  - name: EPnP
    owner: firmware
    limits:
      - stage: "EPnP RANSAC"
        limit: cycles <= +3 %
YAML'
shows 'leviosim check recorded -p isa.ops.f64_add.issue=200 --budget epnp.yaml --baseline baseline.json \
      --junit junit.xml --annotations github || echo "exit status $?"'

figure story-trajectory
needs data
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded
leviosim run --platform gap9 --profile next --data euroc/MH_01_easy_t05_t20 --out other'
shows 'leviosim eval recorded euroc/MH_01_easy_t05_t20 --also other --align posyaw'

# platform_models/CHIPS.md
figure l1-knee
needs data
shows 'cat >l1.yaml <<YAML
base: { data: euroc/MH_01_easy_t05_t20, platform: gap9, frames: "0:100" }
points:
  - grid: { platform.cluster.l1.size: [32KiB, 48KiB, 64KiB, 96KiB, 128KiB, 256KiB], profile: levio }
    list: [{ size: 160x120, workload.cell: 8 }, { size: 320x240, workload.cell: 16 }]
  - grid: { platform.cluster.l1.size: [32KiB, 48KiB, 64KiB, 96KiB, 128KiB, 256KiB], profile: next }
    list:
      - { size: 160x120, workload.cell: 8 }
      - { size: 320x240, workload.cell: 16, workload.features_per_cell: 3 }
YAML
leviosim sweep l1.yaml --out l1 && l1_knee.py l1/sweep.csv >knee.svg'
keeps knee.svg

# README.md
figure slider-before
needs data engine
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded'
shows 'leviosim report recorded --interactive -o chip.html'
photo 1440x1040 chip.html#cluster.icache.shared_size=2KiB

figure slider-after
needs data engine
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded'
shows 'leviosim report recorded --interactive -o chip.html'
photo 1440x1040 chip.html#cluster.icache.shared_size=8KiB

figure timeline
needs data
shows 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --frames 0:60 --out start --timeline frame.svg --timeline-frames 40:41'
keeps frame.svg

figure report
needs data
after 'leviosim run --platform gap9 --data euroc/MH_01_easy_t05_t20 --record --out recorded'
shows 'leviosim report recorded --out report.html'
photo 1280x1200 report.html

figure demo
needs aha
shows 'COLUMNS=80 LINES=24 leviosim demo --quiet | sed "s|file://.*/|file://…/|" | aha --black --title leviosim >demo.html'
photo 680x420 demo.html
