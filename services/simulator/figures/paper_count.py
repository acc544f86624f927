"""The rows of figure 16: what was counted, by phase, beside Equation 12."""

PHASES = ("boot", "identification", "devices", "updates", "task", "forward", "sensor", "fail")
COLUMNS = ("phase", "equation_12", "all_messages", "between_computers", "bytes_between_computers", "bytes_a_second")


def model_words(robots, tasks, blocks_k, blocks_sum_m, seconds):
    """What `trb model` is asked for this run: one robot failed, one sensor was asked by another computer."""
    done = [task for task in tasks if task["state"] != "SKIPPED"]
    direct = sum(task.get("mode") in ("direct", "ros") for task in done)
    return ("--robots", robots, "--direct", direct, "--interpreted", len(done) - direct, "--blocks", blocks_k,
            "--block-tasks", blocks_sum_m, "--sensors", 1, "--seconds", seconds, "--remote-requests", 1, "--faulty", 1)


def rows_of(counted, terms, seconds):
    """One row a phase, those without upkeep summed up, then upkeep and what only the kernel sees."""
    said, taps, capture = counted["said"], counted["taps"], counted["capture"]
    between = {phase: [0, 0] for phase in (*PHASES, "upkeep")}
    for (phase, _), messages in taps.messages.items():
        between[phase][0] += messages
    for (phase, _), size in taps.bytes.items():
        between[phase][1] += size
    # Beacons are no messages of a link: each a datagram, which the taps do not see.
    between["identification"][0] += capture.datagrams
    between["identification"][1] += capture.udp
    updates = between["updates"][0]
    everything = {**said, "updates": updates, "sensor": said["sensor"] - updates}
    paper = {**terms, "devices": terms["devices"] - seconds, "updates": seconds}
    rows = [(phase, int(paper[phase]), everything.get(phase, 0), *between[phase], rate(between[phase][1], seconds)) for phase in PHASES]
    total = [sum(row[i] for row in rows) for i in range(1, 5)]
    rows.append(("total", *total, rate(total[3], seconds)))
    rows.append(("upkeep", "", said["upkeep"], *between["upkeep"], rate(between["upkeep"][1], seconds)))
    rest = capture.tcp + capture.udp - total[3] - between["upkeep"][1]
    rows.append(("connections", "", "", "", rest, rate(rest, seconds)))
    return rows


def subtypes_of(taps, capture):
    """What went between computers, by its subtype."""
    links = [(*key, messages, taps.bytes[key]) for key, messages in taps.messages.items()]
    return sorted([*links, ("identification", "beacon", capture.datagrams, capture.udp)])


def rate(size, seconds):
    return round(size / seconds)
