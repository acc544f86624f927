export const hall = {
  hall: {
    title: 'Hall',
    state: 'State',
    charge: 'Charge',
    task: 'Task',
    counts: 'Robots by state',
    map: 'Map of the hall with {count} {count|robot|robots}. The table has the same.',
    keys: 'Arrows: move. + and −: zoom. 0: all. N, P: next, previous robot. F: follow it.',
    zoomIn: 'Zoom in',
    zoomOut: 'Zoom out',
    all: 'Whole hall',
    follow: 'Follow',
    show: 'Show {robot} on the map',
    noPose: 'Its place is not known',
    empty: 'No robot fits.',
  },
};
