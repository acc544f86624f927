export const design = {
  design: {
    title: 'Design tokens',
    colours: 'Colours',
    type: 'Type',
    states: 'States',
    controls: 'Controls',
    sample: 'Robot 7 stands at the conveyor: 1 234.5 kg',
    spacing: 'Spacing',
  },
};
