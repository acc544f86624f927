export const messages = {
  messages: {
    title: 'Messages',
    node: 'Node',
    type: 'Type',
    phase: 'Phase',
    all: 'all',
    pause: 'Pause',
    goOn: 'Go on ({count} new)',
    none: 'No message has passed yet that fits.',
    leftOut: '{count} {count|message|messages} came too fast to be shown.',
    budget: 'By phase',
    equation: 'Messages that have passed this node since its start, by the phases of the paper’s Equation 12. Upkeep is what the paper does not count.',
    count: 'Messages',
    share: 'Share',
  },
};
